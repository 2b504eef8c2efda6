"""Spheres: full cycles, steady parts of their branches, and runs on a user's surface."""
