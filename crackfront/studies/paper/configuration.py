"""Configurations of the figures: parameters that hold for all scales, and those of one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from crackfront.data.section import Section
from crackfront.data.yaml import ConfigurationError, content_of, sentences
from crackfront.studies.paper.figures import FIGURES

SCALES = ("quick", "paper")
"""Sizes of a figure: minutes on two cores, or the paper's own."""


def load_figure(path: Path, scale: str) -> Section:
    """Parameters of a figure.

    Parameters
    ----------
    path : Path
        YAML file that bears the figure's name. It has the mappings `parameters` (what holds for
        all scales), `quick` and `paper`.
    scale : str
        A name in :data:`SCALES`.

    Returns
    -------
    Section
        Parameters as the figure's scene defines them.

    Raises
    ------
    ConfigurationError
        If there is no such figure, the file cannot be read, or anything in it is unknown, missing
        or out of range; one sentence for each.
    """
    scene = FIGURES.get(path.stem)
    if scene is None:
        raise ConfigurationError(
            f"there is no figure {path.stem!r}; the names of the files are {', '.join(FIGURES)}"
        )
    content = content_of(path)
    sections = ("parameters", *SCALES)
    for key in content.keys() ^ set(sections):
        what = f"unknown key {key}" if key in content else f"key {key} is missing"
        raise ConfigurationError(f"{path}: {what}; the keys here are {', '.join(sections)}")
    given: dict[str, Any] = {}
    for section in ("parameters", scale):
        if not isinstance(content[section], dict):
            raise ConfigurationError(f"{path}: {section} must be a mapping of keys, {{}} if empty")
        for key in given.keys() & content[section].keys():
            raise ConfigurationError(
                f"{path}: {key} stands in parameters and in {section}; remove one"
            )
        given |= content[section]
    try:
        return scene.parameters.model_validate(given)
    except ValidationError as error:
        raise ConfigurationError(
            "\n".join(f"{path}: {line}" for line in sentences(error.errors(), scene.parameters))
        ) from error


def figure_files(path: Path, scale: str) -> list[str]:
    """Files that a figure reads beside its configuration.

    Parameters
    ----------
    path, scale
        As in :func:`load_figure`.
    """
    parameters = load_figure(path, scale)
    return [str(value) for _, value in parameters if isinstance(value, Path)]
