"""Loads, the fronts that follow them, and what is recorded of each."""
