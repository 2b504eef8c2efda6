"""Snakemake as `make` calls it: it needs no home, and Ctrl-C is a sentence while it starts, too."""

import contextlib
import os
import sys
import tempfile
from pathlib import Path


def ensure_cache() -> None:
    """Name a folder for temporary files as the cache if the user's cannot be written."""
    with contextlib.suppress(RuntimeError):  # of a user that has neither HOME nor a name
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        if _is_writable(Path(home, "snakemake")):
            return
    # Where `crackfront` keeps its kernels in this case. Nobody else may have made it.
    folder = Path(tempfile.gettempdir(), f"crackfront-{os.geteuid()}")
    if not _is_writable(folder) or folder.is_symlink() or folder.stat().st_uid != os.geteuid():
        sys.exit("No folder for caches can be written; set XDG_CACHE_HOME to one")
    os.environ["XDG_CACHE_HOME"] = str(folder)
    os.environ.setdefault("NUMBA_CACHE_DIR", str(folder))


def _is_writable(folder: Path) -> bool:
    """Whether files can be written in a folder, which is made if it is missing."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def run() -> None:
    """Run Snakemake, and name its log if a job failed."""
    from snakemake.cli import main

    try:
        main()
    except SystemExit as ended:
        if ended.code:
            sys.exit("The workflow did not finish; the last log in .snakemake/log/ says more")


try:
    ensure_cache()
    run()
except KeyboardInterrupt:
    sys.exit("Interrupted before any job began; run the same command again")
