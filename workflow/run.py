"""Snakemake as `make` calls it.

`--plan SWEEP` before its options looks at the files of a sweep first, since Snakemake does not look
inside files; in the same process, because both import the same libraries. Snakemake needs no home,
Ctrl-C is a sentence while it starts, too, and it does not announce its profile.
"""

import contextlib
import io
import os
import sys
import tempfile
from pathlib import Path
from typing import TextIO


def ensure_cache() -> None:
    """Name a folder for temporary files as the cache if the user's cannot be written."""
    with contextlib.suppress(RuntimeError):  # a user may have neither HOME nor a name
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        if _is_writable(Path(home, "snakemake")):
            return
    # `crackfront` keeps its kernels here in this case. Nobody else may have made the folder.
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


def print_unless_profile(text: str, file: TextIO) -> None:
    """Print what the command line of Snakemake says, except which profile it uses."""
    if not text.startswith("Using profile"):
        print(text, file=file)


def plan(sweep: str) -> None:
    """Set damaged files of a sweep aside by `crackfront plan`, and print how much is to run."""
    from crackfront.cli import main as crackfront

    text = io.StringIO()
    try:
        with contextlib.redirect_stdout(text):
            crackfront(["plan", sweep], prog_name="crackfront")
    except SystemExit as ended:
        if ended.code:
            raise
    sizes, _, _ = text.getvalue().partition("\n\n")
    sys.stdout.write(f"{sizes}\n")
    sys.stdout.flush()


def run() -> None:
    """Run Snakemake, and name its log if a job failed."""
    from snakemake import cli

    cli.print = print_unless_profile
    try:
        cli.main()
    except SystemExit as ended:
        if ended.code:
            sys.exit("The workflow did not finish; the last log in .snakemake/log/ says more")


try:
    ensure_cache()
    if sys.argv[1:2] == ["--plan"]:
        plan(sys.argv[2])
        del sys.argv[1:3]
    run()
except KeyboardInterrupt:
    sys.exit("Interrupted before any job began; run the same command again")
