"""What is built on all of the rest and nothing imports."""
