"""Golden files: numbers of a version, their comparison with new ones, and their renewal."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from crackfront.core.arrays import Array

Values = dict[str, Array]
"""Quantities of a scene, by their names."""

Scenes = dict[str, Values]
"""Scenes by their names."""

TOLERANCE = 1e-10
"""Difference that counts as moved, relative to the largest entry of a quantity.

Instruction sets and solvers differ by up to 3e-12; a coefficient changed by 1e-6 moves places of
fronts by 1e-8 or more.
"""

_SMALLEST_SCALE = 1e-3
"""Quantities below it are compared as if they had this size: they may be zero but for rounding."""

_DIGITS = 14
"""Significant digits in a file."""

COMMAND = "python -m tests.golden"


@dataclass(frozen=True)
class Movement:
    """A quantity that is no longer what the file says."""

    scene: str
    quantity: str
    difference: float
    """Largest difference, relative to the largest entry of the quantity; infinite where shapes or
    missing values differ."""
    tolerance: float
    """Difference that is not a movement."""

    def __str__(self) -> str:
        where = f"{self.scene}: {self.quantity}"
        if not math.isfinite(self.difference):
            return f"{where} has other entries or is missing"
        times = self.difference / self.tolerance
        return f"{where} moved by {self.difference:.2g} of its size, {times:.3g} tolerances"


@dataclass(frozen=True)
class Golden:
    """Content of a golden file."""

    version: int
    scenes: Scenes
    given: Scenes = field(default_factory=dict)
    """What the scenes are computed from, where that is stored; once it is there, never renewed."""


class NotRaisedError(ValueError):
    """Numbers moved, but their version is that of the file."""


def movements(
    golden: Mapping[str, Values], computed: Mapping[str, Values], tolerance: float = TOLERANCE
) -> list[Movement]:
    """Quantities of computed scenes that moved from the golden ones, the largest first."""
    moved = []
    for scene, values in computed.items():
        stored = golden.get(scene, {})
        for quantity in dict.fromkeys((*stored, *values)):
            difference = _difference(stored.get(quantity), values.get(quantity))
            if difference > tolerance:
                moved.append(Movement(scene, quantity, difference, tolerance))
    return sorted(moved, key=lambda movement: -movement.difference)


def _difference(golden: Array | None, computed: Array | None) -> float:
    """Largest difference, relative to the largest golden entry; infinite for other shapes."""
    if golden is None or computed is None or golden.shape != computed.shape:
        return math.inf
    is_finite = np.isfinite(golden)
    if not np.array_equal(is_finite, np.isfinite(computed)):
        return math.inf
    if not np.any(is_finite):
        return 0.0
    scale = max(float(np.max(np.abs(golden[is_finite]))), _SMALLEST_SCALE)
    return float(np.max(np.abs(computed[is_finite] - golden[is_finite]))) / scale


def advice(moved: list[Movement], version: str, most: int = 8) -> str:
    """What moved, and what to do about it."""
    lines = [str(movement) for movement in moved[:most]]
    if len(moved) > most:
        lines.append(f"... and {len(moved) - most} other quantities")
    return "\n".join(
        [
            "numbers moved:",
            *lines,
            "If this was not intended, it is a fault. If it was, raise "
            f"{version} in crackfront/core/versions.py and add a line to its history, "
            f"run `{COMMAND}`, and name the change in the commit.",
        ]
    )


def renewed(golden: Golden, version: int, computed: Scenes, name: str) -> Golden:
    """The golden numbers of a version, called `name` in the sources.

    Within a version numbers stay as they are, scenes that are new come in and others go.

    Raises
    ------
    NotRaisedError
        If numbers moved and the version is that of the golden ones.
    """
    if version != golden.version:
        return replace(golden, version=version, scenes=computed)
    kept_scenes = {scene: values for scene, values in computed.items() if scene in golden.scenes}
    if moved := movements(golden.scenes, kept_scenes):
        raise NotRaisedError(f"{name} is still {version}, but {advice(moved, name)}")
    return replace(golden, scenes=computed | {scene: golden.scenes[scene] for scene in kept_scenes})


def read_golden(path: Path) -> Golden:
    """Content of a file."""
    content = json.loads(path.read_text())
    scenes, inputs = (
        {
            scene: {name: np.array(values, float) for name, values in quantities.items()}
            for scene, quantities in content.get(part, {}).items()
        }
        for part in ("scenes", "given")
    )
    return Golden(content["version"], scenes, inputs)


def write_golden(path: Path, golden: Golden) -> None:
    """Write a file with one line for each quantity."""
    parts = [f'"version": {golden.version}', f'"scenes": {_scenes_text(golden.scenes)}']
    if golden.given:
        parts.append(f'"given": {_scenes_text(golden.given)}')
    path.write_text("{\n" + ",\n".join(parts) + "\n}\n")


def _scenes_text(scenes: Scenes) -> str:
    """Scenes as JSON."""
    blocks = []
    for scene, values in scenes.items():
        lines = [
            f"  {json.dumps(quantity)}: {json.dumps(_rounded(entries.tolist()))}"
            for quantity, entries in values.items()
        ]
        blocks.append(f" {json.dumps(scene)}: {{\n" + ",\n".join(lines) + "\n }")
    return "{\n" + ",\n".join(blocks) + "\n}"


def _rounded(entries: Any) -> Any:
    """Entries with the digits of a file; null for what is not finite."""
    if isinstance(entries, list):
        return [_rounded(entry) for entry in entries]
    return float(f"{entries:.{_DIGITS}g}") if math.isfinite(entries) else None
