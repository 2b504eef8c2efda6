"""One reader for tables in texts: of loops, samples, maps, points and spectral densities."""
