"""Checks of arguments of the library: their types, names, and files."""

from __future__ import annotations

import difflib
import math
import stat
from collections.abc import Iterable
from numbers import Real
from pathlib import Path
from typing import Any

from crackfront.core.words import in_bytes

_TYPES_SHOWN_BY_VALUE = (str, int, float, bool, type(None))
"""Types of which a message shows the value; of all others it names the type."""

_KINDS = {"d": "a folder", "p": "a pipe", "s": "a socket", "c": "a device", "b": "a device"}
"""What a path that is not a file names, by the first letter of its mode."""


def check_type(
    name: str, value: object, kind: type[Any] | tuple[type[Any], ...], expected: str
) -> None:
    """Raise TypeError if an argument has another type, with what is expected.

    Examples
    --------
    >>> check_type("surface", "scan.ibw", list, "a list of heights")
    Traceback (most recent call last):
    TypeError: surface is 'scan.ibw'; give a list of heights
    """
    if not isinstance(value, kind):
        raise TypeError(f"{name} is {_shown(value)}; give {expected}")


def check_numbers(**values: object) -> None:
    """Raise TypeError if an argument is not a number."""
    for name, value in values.items():
        check_type(name, value, Real, "a number")


def check_positive(**values: float) -> None:
    """Raise ValueError if an argument is not positive and finite."""
    for name, value in values.items():
        if not 0 < value < math.inf:
            raise ValueError(f"{name} is {value}; it must be positive and finite")


def nearest_name(name: str, names: Iterable[str], otherwise: str = "choose one of") -> str:
    """What to do about an unknown name: the known one that is near it, or else all of them.

    Examples
    --------
    >>> nearest_name("hrust", ["hurst", "roll_off"])
    'did you mean hurst?'
    >>> nearest_name("x", ["hurst", "roll_off"], "the keys here are")
    'the keys here are hurst, roll_off'
    """
    names = list(names)
    near = difflib.get_close_matches(name, names, n=1)
    return f"did you mean {near[0]}?" if near else f"{otherwise} {', '.join(names)}"


def _shown(value: object) -> str:
    """The value, or its type where that says more."""
    if isinstance(value, _TYPES_SHOWN_BY_VALUE):
        return repr(value)
    kind = type(value)
    home = "" if kind.__module__ == "builtins" else f"{kind.__module__.partition('.')[0]}."
    return f"a {home}{kind.__qualname__}"


def regular_file(path: Path, most_bytes: float = math.inf) -> Path:
    """A path that names a file with an end, and not more than so many bytes.

    ValueError if it names a folder, a pipe or a device, or a file that is larger; OSError if there
    is nothing of that name.
    """
    about = path.stat()
    if not stat.S_ISREG(about.st_mode):
        kind = _KINDS.get(stat.filemode(about.st_mode)[0], "something else")
        raise ValueError(f"{path} is {kind}, not a file; name a file")
    if about.st_size > most_bytes:
        raise ValueError(
            f"{path} has {in_bytes(about.st_size)}; more than {in_bytes(most_bytes)} are not read"
        )
    return path
