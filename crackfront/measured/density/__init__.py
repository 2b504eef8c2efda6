"""Spectral density of each scan, what its instrument does to it, and the waves to trust."""
