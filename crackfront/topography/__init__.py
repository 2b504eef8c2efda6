"""Measured surfaces: from scans to a spectrum, and from that to a prediction."""
