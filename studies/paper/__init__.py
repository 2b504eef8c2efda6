"""The computed figures of the paper."""
