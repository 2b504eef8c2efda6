"""Measured surfaces: from scans to a spectrum, and from that to a prediction.

Data pass through the folders in the order `scan`, `density`, `spectrum`, `prediction`, `page`; each
imports from those before it. `options` has what a user may choose, `predict` the functions of the
library, `tile` a scan as a surface to press on, `tables` the reader of all tables, `samples` series
of predictions, `loops` measured loops, and `perimeters` the edge of a contact in a video.
"""
