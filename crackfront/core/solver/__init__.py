"""The first metastable front in the direction of motion."""
