"""What people call on a surface of their own: random and given surfaces, loops, instabilities."""
