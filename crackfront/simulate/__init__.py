"""One contact: its parameters, numerics for an asked error, what it costs, its loop."""
