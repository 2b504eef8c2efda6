"""Places that many tests read."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
"""Folder of the project."""

TEST = ROOT / "config/test.yaml"
"""The smallest configuration of a sweep."""
