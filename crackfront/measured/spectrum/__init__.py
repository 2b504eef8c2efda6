"""One spectrum of all scans of a surface, what others agree as well, and its measures."""
