"""Straight fronts on springs: over a period of a tile, and on a user's surface."""
