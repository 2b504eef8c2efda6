"""What a figure of the paper is, and how its name leads to its module.

To add one, write a file here that ends in `FIGURE = Figure(...)`, named as its configuration in
config/figures with _ for -: parameters, computation, checks and drawing stand in it, in this order.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast, get_type_hints

import numpy as np
from numpy.typing import NDArray

from crackfront.sweep.section import (
    ConfigurationError,
    Section,
    validated,
    yaml_mapping,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

    from studies.paper.checks import Check
    from studies.paper.drawing import Animation

Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure; the types of what it computes are those that `compute` is annotated with."""

    title: str
    compute: Callable[..., Any]  # data from parameters, progress and, if they name a sweep, its fit
    checks: Callable[[Any], tuple[Check, ...]]
    draw: Callable[[Any], Drawing]
    animate: Callable[[Any], Animation] | None = None  # the drawing is its last frame
    # Expected processor time in seconds; 0 if it is never a minute.
    seconds: Callable[[Any], float] = lambda parameters: 0.0

    @property
    def parameters(self) -> type[Section]:
        """Type of its configuration, which raises if the figure cannot be computed."""
        return cast(type[Section], get_type_hints(self.compute)["parameters"])

    @property
    def record(self) -> type[Any]:
        """Dataclass of its data."""
        return cast(type[Any], get_type_hints(self.compute)["return"])


def values_of(source: Any, *names: str) -> dict[str, Any]:
    """Attributes of an object by their names; all fields of a dataclass by default."""
    return {
        name: getattr(source, name) for name in names or [field.name for field in fields(source)]
    }


FIGURES = tuple(
    path.stem.replace("_", "-")
    for group in ("main", "si", "beyond")
    for path in sorted(Path(__file__).parent.glob(f"{group}_*.py"))
)
"""Names of all figures, the main text first."""


def figure(name: str) -> Figure:
    """Figure of a name in :data:`FIGURES`."""
    loaded: Figure = importlib.import_module(_module_name(name)).FIGURE
    return loaded


def figure_sources(name: str) -> tuple[Path, Path]:
    """Files of the modules that compute the data of a figure, and that draw it.

    Both are one file where the data take no more than a moment.
    """
    module = importlib.import_module(_module_name(name))
    computing = sys.modules[module.FIGURE.compute.__module__]
    return Path(str(computing.__file__)), Path(str(module.__file__))


def _module_name(name: str) -> str:
    """Full name of the module of a figure."""
    return f"studies.paper.{name.replace('-', '_')}"


SCALES = ("quick", "paper")
"""Sizes of a figure: minutes on two cores, or the paper's own."""


def load_figure(path: Path, scale: str) -> Section:
    """Parameters of a figure at a scale, from the YAML file that bears its name.

    The file has the mappings `parameters` (what all scales share), `quick` and `paper`. A
    ConfigurationError says what is unknown, missing or out of range.
    """
    if path.stem not in FIGURES:
        raise ConfigurationError(
            f"{path.stem!r} is not a figure; the names of the files are {', '.join(FIGURES)}"
        )
    content = yaml_mapping(path)
    sections = ("parameters", *SCALES)
    for key in content.keys() ^ set(sections):
        problem = f"unknown key {key}" if key in content else f"key {key} is missing"
        raise ConfigurationError(f"{path}: {problem}; the keys here are {', '.join(sections)}")
    values: dict[str, Any] = {}
    for section in ("parameters", scale):
        if not isinstance(content[section], dict):
            raise ConfigurationError(f"{path}: {section} must be a mapping of keys, {{}} if empty")
        for key in values.keys() & content[section].keys():
            raise ConfigurationError(
                f"{path}: {key} stands in parameters and in {section}; remove one"
            )
        values |= content[section]
    return validated(path, values, figure(path.stem).parameters)


def sweep_of_figure(path: Path, scale: str) -> Path:
    """Sweep that a figure shows at a scale, without the modules that compute the figure."""
    try:
        return Path(yaml_mapping(path)[scale]["sweep"])
    except (LookupError, TypeError):
        load_figure(path, scale)  # says what is wrong
        raise


def files_of_figure(parameters: Section) -> list[Path]:
    """Files that the parameters of a figure name."""
    return [value for _, value in parameters if isinstance(value, Path) and value.is_file()]
