"""The version of the package: that of the installed one, which setuptools-scm takes from git."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version


def _version() -> str:
    """Version, or 0+unknown where the sources are imported without being installed."""
    try:
        return version("crackfront")
    except PackageNotFoundError:
        return "0+unknown"


__version__ = _version()
"""Version of the package."""
