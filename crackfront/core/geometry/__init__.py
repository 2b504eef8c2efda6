"""Geometries of the contact: what restores a front, and how its rays lie.

To add one, write a file here with a NamedTuple of arrays and numbers that follows
:class:`crackfront.core.geometry.base.Geometry` and implements each function of that module.
"""
