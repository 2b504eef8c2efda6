"""Numbers of things, bytes and seconds in words, and lines of a readable width."""

from __future__ import annotations

import math
import re
import textwrap

_WIDTH = 100
"""Columns of a line of text that a command prints."""

_LABEL = re.compile(r" *\S+( \S+)*  +(?=\S)")
"""Label of a row, which two spaces or more separate from its text."""


def counted(number: int, noun: str) -> str:
    """A number of things, whose plural takes an s.

    Examples
    --------
    >>> counted(1, "scan"), counted(3, "scan")
    ('1 scan', '3 scans')
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def in_bytes(number: float) -> str:
    """Bytes in words.

    Examples
    --------
    >>> in_bytes(3e11), in_bytes(2.4e7)
    ('300 GB', '24 MB')
    """
    for power, name in ((18, "EB"), (15, "PB"), (12, "TB"), (9, "GB")):
        if number >= 10.0**power:
            return f"{number / 10.0**power:.3g} {name}"
    return f"{number / 1e6:.3g} MB"


def in_time(seconds: float) -> str:
    """Time in words.

    Examples
    --------
    >>> in_time(0.452), in_time(110.0), in_time(9000.0), in_time(1e12)
    ('0.45 s', '110 s', '2.5 hours', '3.17e+04 years')
    """
    if not math.isfinite(seconds):
        return "for ever"
    for unit, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "hours"), (60.0, "min")):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds:.0f} s" if seconds >= 10 else f"{seconds:.2g} s"


def wrapped(text: str) -> str:
    """Text without lines of more than 100 columns.

    Continued lines begin under the text of a row that has a label, and else two columns further.

    Examples
    --------
    >>> print(wrapped("e_el    " + " ".join(10 * ["conformity"])))
    e_el    conformity conformity conformity conformity conformity conformity conformity conformity
            conformity conformity
    """
    return "\n".join(map(_wrapped_line, text.split("\n")))


def _wrapped_line(line: str) -> str:
    """One line, or the lines that continue it."""
    label = _LABEL.match(line)
    indent = len(label[0]) if label else len(line) - len(line.lstrip()) + 2
    return textwrap.fill(
        line,
        _WIDTH,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
