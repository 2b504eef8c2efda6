"""Adhesion hysteresis of rough spheres by crack-front pinning."""

__version__ = "0.1.0"
