"""Loops that a rig measured: force, contact radius and displacement of a sphere."""
