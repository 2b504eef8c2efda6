"""Whether the theory applies to a sphere on a surface, what it predicts, and its simulation."""
