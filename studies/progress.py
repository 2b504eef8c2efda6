"""Lines that a computation reports while it runs."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with a line when a part of a computation is done."""


def silent(line: str) -> None:
    """Ignore a line of progress."""
