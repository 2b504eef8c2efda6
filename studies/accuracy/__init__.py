"""How wrong the numerics are: scenes, errors against converged ones, and the laws they give."""
