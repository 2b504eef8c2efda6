"""The folder of the results of a configuration, and whether it may be used."""

from __future__ import annotations

import os
import re
from pathlib import Path

from crackfront.sweep.section import ConfigurationError


def results_folder(path: Path) -> Path:
    """Folder for the results of a configuration file, named after it.

    ConfigurationError if the name is not one for a folder and a command line.
    """
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", path.stem):
        raise ConfigurationError(
            f"the results are named after {path.name!r}, which must consist of letters, digits, "
            "_, - and dots; rename it"
        )
    return Path("results") / path.stem


SOURCE = "configuration.path"
"""File of a results folder that states the path of its configuration, relative to the folder."""


def check_layout(results: Path) -> None:
    """Raise ConfigurationError if results are of a version that kept curves in tar files."""
    if any((results / "curves").glob("*.tar")):
        raise ConfigurationError(
            f"{results} has results in the layout of an older version, which this one does not "
            "read; start a new folder: rename this one, or name another by --output"
        )


def check_configuration(path: Path, results: Path) -> None:
    """Raise ConfigurationError if results belong to another configuration that is still there.

    Two configurations of one name in two folders would share one folder of results.
    """
    source = results / SOURCE
    if not source.is_file():
        return
    earlier = results / source.read_text(encoding="utf-8").strip()
    if (
        earlier.is_file()
        and not earlier.samefile(path)
        and earlier.read_bytes() != path.read_bytes()
    ):
        raise ConfigurationError(
            f"{results} has the results of {os.path.relpath(earlier)}, another configuration than "
            f"{path}; rename one of them, or name another folder by --output"
        )
