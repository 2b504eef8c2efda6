"""Canaries: numbers that are recomputed every night and compared with the stored ones.

Each study has some, in its module `canaries`: a function of the study on a reduced configuration,
which takes a few seconds. Boundary elements have a small case; times have none.
"""

from __future__ import annotations

import importlib
import math
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass

from crackfront.analysis.estimate import Estimate, with_error
from studies.numbers import Number, stored

Canary = Callable[[], Mapping[str, Number]]
"""Measures numbers again, each with its error."""

PART_OF_ERROR = 0.1
"""Part of its error by which a number may move. Seeds are the same, so that chance moves none:
without vector units none moves by more than 0.003 of its error."""

STUDIES = ("law", "accuracy", "boundary-elements", "paper")
"""Studies with canaries."""


def interval_number(estimate: Estimate[float], unit: str = "1") -> Number:
    """Number of an estimate, with half of its interval."""
    return Number(float(estimate.value), float(estimate.high - estimate.low) / 2, unit)


@dataclass(frozen=True, slots=True)
class Comparison:
    """A stored number and the same number measured again."""

    name: str
    stored: Number
    now: Number

    @property
    def in_errors(self) -> float:
        """Distance of both over the stored error; infinite if a number or the error is missing."""
        distance = abs(self.now.value - self.stored.value)
        if distance == 0:
            return 0.0
        return distance / self.stored.error if self.stored.error else math.inf

    @property
    def has_moved(self) -> bool:
        """Whether the number is further away than a part of its error, or not a number."""
        return not self.in_errors <= PART_OF_ERROR

    def __str__(self) -> str:
        """Sentence that names both numbers and their distance."""
        unit = "" if self.stored.unit == "1" else f" {self.stored.unit}"
        before = with_error(self.stored.value, self.stored.error or 0.0)
        return (
            f"{self.name}: {before}{unit} stored, {self.now.value:.6g} now, "
            f"moved by {self.in_errors:.2g} errors"
        )


@dataclass(frozen=True, slots=True)
class Result:
    """What a canary measured, and the processor time that it took in s."""

    study: str
    name: str
    numbers: Mapping[str, Number]
    seconds: float

    def comparisons(self) -> Iterator[Comparison]:
        """Comparisons with the stored numbers; ValueError if there are none."""
        expected = stored(self.study).canaries
        for name in expected:
            if name.startswith(f"{self.name}, ") and name not in self.numbers:
                raise ValueError(f"{name!r} of {self.study} is stored, but not measured any more")
        for name, number in self.numbers.items():
            if name not in expected:
                raise ValueError(
                    f"{name!r} of {self.study} is not stored; run python -m studies canaries --keep"
                )
            yield Comparison(f"{self.study}: {name}", expected[name], number)


def canaries() -> dict[tuple[str, str], Canary]:
    """All canaries by study and name."""
    modules = {
        study: importlib.import_module(f"studies.{study.replace('-', '_')}.canaries")
        for study in STUDIES
    }
    return {
        (study, name): canary
        for study, module in modules.items()
        for name, canary in module.CANARIES.items()
    }


def chosen_canaries(studies: Collection[str]) -> dict[tuple[str, str], Canary]:
    """Canaries of some studies, or of all if none is named; ValueError for one without canaries."""
    for study in studies:
        if study not in STUDIES:
            names = ", ".join(STUDIES)
            raise ValueError(
                f"{study} does not have canaries; the studies with canaries are {names}"
            )
    return {name: canary for name, canary in canaries().items() if name[0] in (studies or STUDIES)}


def measured(chosen: Mapping[tuple[str, str], Canary]) -> Iterator[Result]:
    """Results of some canaries, one after the other."""
    for (study, name), canary in chosen.items():
        begun = time.process_time()
        numbers = {f"{name}, {quantity}": number for quantity, number in canary().items()}
        yield Result(study, name, numbers, time.process_time() - begun)
