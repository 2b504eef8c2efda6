"""The physics of a crack front; imports nothing else of the package."""
