"""The model against boundary elements of the same rough sphere."""
