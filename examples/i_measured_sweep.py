"""
A sweep of a measured surface
=============================

Surfaces of the spectrum of a scan, at its own heights and at 70% of them. The configuration
``film.yaml`` names the scan beside it; ``crackfront simulate film.yaml`` and ``crackfront
aggregate film.yaml`` make the same table.
"""

import sys
from pathlib import Path

import crackfront as cf

film = Path(sys.argv[0]).with_name("film.yaml")
table = cf.run_sweep(film, "results/film", progress=False)
print(table.w_appr.values, table.w_retr.values, sep="\n")
