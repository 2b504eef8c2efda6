"""How the law of k was measured, fitted and drawn; avalanches and roughness of straight fronts."""
