"""A surface and its prediction as text, JSON, rows of a table, and a figure."""
