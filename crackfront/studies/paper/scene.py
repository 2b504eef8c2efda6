"""What a figure of the paper is made of: parameters, a computation, a record, checks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from crackfront.data.section import Section
from crackfront.studies.paper.checks import Check

Progress = Callable[[str], None]
"""Called with a line when a part of a computation is done."""


@dataclass(frozen=True, slots=True)
class FigureScene:
    """One figure: what it needs and nothing else.

    Attributes
    ----------
    title : str
        Which figure of the paper, and what it shows.
    parameters : type
        Section that its configuration fills; refuses values that cannot be computed.
    record : type
        Dataclass of its data.
    compute : callable
        From the parameters, and a function for progress, to the record; where the parameters
        name a sweep, with the fit of its results as a third argument.
    checks : callable
        From the record to the claims about it.
    animated : bool
        Whether it is drawn as an animation as well; the figure is then its last frame.
    """

    title: str
    parameters: type[Section]
    record: type[Any]
    compute: Callable[..., Any]
    checks: Callable[[Any], tuple[Check, ...]]
    animated: bool = False
