"""Snakemake as `make` calls it: Ctrl-C is a sentence while it starts, too."""

import sys

try:
    from snakemake.cli import main

    main()
except KeyboardInterrupt:
    sys.exit("Interrupted before any job began; run the same command again")
