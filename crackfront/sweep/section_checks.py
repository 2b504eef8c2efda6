"""Checks that sections of a configuration share."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from crackfront.sweep.section import Section, section_error


def check_makes(make: Callable[[], object]) -> None:
    """Raise if the record of a section raises ValueError for its values."""
    try:
        make()
    except ValueError as error:
        raise section_error(str(error)) from error


def check_distinct(name: str, values: Iterable[object]) -> None:
    """Raise if a value occurs twice."""
    earlier = set()
    for value in values:
        if value in earlier:
            raise section_error(f"{name} {value!r} stands twice; remove or change one")
        earlier.add(value)


def check_not_overruled(section: Section, decider: str, keys: Iterable[str]) -> None:
    """Raise if a section has a key whose value follows from the key `decider`."""
    if overruled := [key for key in keys if getattr(section, key) is not None]:
        raise section_error(
            f"{decider} already decides {', '.join(overruled)}; remove one or the other"
        )


def check_exactly_one(problem: str, values: Iterable[Any], otherwise: str = "give one") -> None:
    """Raise unless exactly one of some values is there."""
    n_value = sum(value is not None for value in values)
    if n_value != 1:
        raise section_error(f"{problem}; {'remove one' if n_value else otherwise}")


def missing_keys(section: Section, keys: Iterable[str]) -> list[str]:
    """Keys, of some names, that a section lacks."""
    return [key for key in keys if getattr(section, key) is None]
