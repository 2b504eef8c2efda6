"""What was measured with crackfront, one folder a study; nothing imports them."""
