"""Factors k that others found."""

PAPER_FACTOR, PERTURBATION_FACTOR = 3.0, 4.0
"""k of the paper's fit, and of second-order perturbation theory in the limit of weak disorder."""
