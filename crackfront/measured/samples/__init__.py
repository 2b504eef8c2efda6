"""Series of samples: read from a table or YAML, and predicted, a row each."""
