"""The work of adhesion along the rays of the front, sampled where the front is."""
