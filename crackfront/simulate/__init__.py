"""One contact: its parameters, numerics for a given error, its cost, its loop."""
