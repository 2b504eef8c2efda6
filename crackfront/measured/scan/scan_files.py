"""What a file must be before a library reads it: regular, and of bearable size."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from pathlib import Path

from crackfront.core.arguments import regular_file
from crackfront.core.resources import check_memory, memory_at_hand

_BYTES_PER_POINT = 100
"""Memory that the analysis of a map takes for a point: heights, transforms, wavevectors."""

LARGEST_FILE = 0.125
"""Largest file in parts of the memory: its points need several times what they take there."""


def check_readable(path: Path) -> None:
    """Raise if a path is not a regular file, or the file is empty or larger than the memory."""
    if not regular_file(path, LARGEST_FILE * memory_at_hand()).stat().st_size:
        raise ValueError(f"{path} is empty; export it from the instrument again")


def check_points(path: Path, counts: Sequence[int]) -> None:
    """Raise if a map has more points than fit in memory, before any of them is read."""
    check_memory(
        f"{path}, which claims {' x '.join(map(str, counts))} points,",
        _BYTES_PER_POINT * math.prod(map(float, counts)),
        "export a part of the map, or with fewer points",
    )


def checksum(path: Path) -> str:
    """Eight hexadecimal digits of the content of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:8]
