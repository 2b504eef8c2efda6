"""Drawing: the style of the package, and what is drawn on axes. All in reduced units."""
