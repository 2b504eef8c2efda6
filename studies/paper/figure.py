"""What a figure of the paper is, and where it is found by its name.

To add one, write a file here that ends in `FIGURE = Figure(...)`, named as its configuration in
config/figures with _ for -: parameters, computation, checks and drawing stand in it, in this order.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from crackfront.analysis.estimate import with_error
from crackfront.core.fingerprint import fingerprint
from crackfront.data.section import ConfigurationError, Section, content_of, validated

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

    from crackfront.plots.animation import Animation

Progress = Callable[[str], None]
"""Called with a line when a part of a computation is done."""


@dataclass(frozen=True, slots=True)
class Check:
    """One claim and whether it holds.

    Attributes
    ----------
    claim : str
        What the paper states, or what must be true.
    expected : str
        Its number, with the tolerance.
    found : str
        What the figure's data say.
    passed : bool
        Whether they agree.
    remark : str
        Where the difference comes from, or what the number rests on.
    law : str
        What the law of k says in place of the paper, where what was found agrees with it.
    """

    claim: str
    expected: str
    found: str
    passed: bool
    remark: str = ""
    law: str = ""

    @property
    def result(self) -> Result:
        """One of three: a difference that the law of k foretells is none that wants a cause."""
        if self.passed:
            return "agrees"
        return "differs as the law of k says" if self.law else "FAIL"


Result = Literal["agrees", "differs as the law of k says", "FAIL"]
"""How a check ends."""


def close_to(
    claim: str,
    found: float,
    expected: float,
    tolerance: float,
    *,
    units: str = "",
    remark: str = "",
    law: tuple[float, float] | None = None,
) -> Check:
    """Check that a number lies within an absolute tolerance of another.

    Parameters
    ----------
    claim : str
        What is compared.
    found, expected : float
        The numbers.
    tolerance : float
        Largest difference, in the same units.
    units : str, optional
        Their units.
    remark : str, optional
        What the number rests on.
    law : tuple of float, optional
        The number that the law of k gives, and the half of its interval.

    Examples
    --------
    >>> close_to("pull-off", -1.5001, -1.5, 1e-3).passed
    True
    """
    after = f" {units}" if units else ""
    said = ""
    if law is not None and abs(found - law[0]) <= law[1]:
        said = f"{with_error(*law)}{after}"
    return Check(
        claim,
        f"{with_error(expected, tolerance)}{after}",
        f"{found:.6g}{after}",
        abs(found - expected) <= tolerance,
        remark,
        said,
    )


def checks_table(checks: Iterable[Check]) -> Iterator[str]:
    """Lines of a Markdown table.

    Parameters
    ----------
    checks : iterable of Check
        Its rows.
    """
    yield "| claim | expected | found | result | remark |"
    yield "| --- | --- | --- | --- | --- |"
    for check in checks:
        result: str = check.result
        if result == "FAIL":
            result = f"**{result}**"
        elif check.law and not check.passed:
            result = f"{result}: {check.law}"
        yield (f"| {check.claim} | {check.expected} | {check.found} | {result} | {check.remark} |")


@dataclass(frozen=True, slots=True)
class Figure:
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
    draw : callable
        From the record to its drawing; matplotlib is imported there and not before.
    animate : callable or None
        From the record to its animation, where it has one; the drawing is then the last frame.
    seconds : callable
        From the parameters to the processor time that the computation is expected to take,
        roughly; none where that is never a minute. (Units: s)
    """

    title: str
    parameters: type[Section]
    record: type[Any]
    compute: Callable[..., Any]
    checks: Callable[[Any], tuple[Check, ...]]
    draw: Callable[[Any], Drawing]
    animate: Callable[[Any], Animation] | None = None
    seconds: Callable[[Any], float] = lambda parameters: 0.0


_GROUPS = ("main", "si", "beyond")

FIGURES = tuple(
    sorted(
        (
            path.stem.replace("_", "-")
            for path in Path(__file__).parent.glob("*_*.py")
            if path.stem.split("_")[0] in _GROUPS
        ),
        key=lambda name: (_GROUPS.index(name.split("-")[0]), name),
    )
)
"""Names of all figures, those of the main text first."""


def figure(name: str) -> Figure:
    """Figure of a name in :data:`FIGURES`."""
    found: Figure = importlib.import_module(_module(name)).FIGURE
    return found


def _module(name: str) -> str:
    """Module of a figure."""
    return f"studies.paper.{name.replace('-', '_')}"


@functools.cache
def figure_fingerprint(name: str) -> str:
    """Twelve hexadecimal digits that change with what the data of a figure come from."""
    found = figure(name)
    return fingerprint(*_full_names(found.parameters, found.record, found.compute))


@functools.cache
def drawing_fingerprint(name: str) -> str:
    """Twelve hexadecimal digits that change with the drawing and the animation of a figure."""
    found = figure(name)
    parts = [found.record, found.draw, *([found.animate] if found.animate else [])]
    saved = "crackfront.plots.style.save_figure", "crackfront.plots.animation.save_animation"
    return fingerprint(*_full_names(*parts), *saved)


def checks_fingerprint() -> str:
    """Twelve hexadecimal digits that change with the checks of any figure."""
    return fingerprint(*_full_names(checks_table, *(figure(name).checks for name in FIGURES)))


def _full_names(*parts: Any) -> list[str]:
    """Names of classes and functions, with their modules."""
    return [f"{part.__module__}.{part.__qualname__}" for part in parts]


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
        Parameters as the figure defines them.

    Raises
    ------
    ConfigurationError
        If there is no such figure, the file cannot be read, or anything in it is unknown, missing
        or out of range; one sentence for each.
    """
    if path.stem not in FIGURES:
        raise ConfigurationError(
            f"there is no figure {path.stem!r}; the names of the files are {', '.join(FIGURES)}"
        )
    section_type = figure(path.stem).parameters
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
    return validated(path, given, section_type)


def settings_fingerprint(path: Path, scale: str) -> str:
    """Twelve hexadecimal digits that change with the parameters of a figure.

    So they do with the content of the files that these name.

    Parameters
    ----------
    path, scale
        As in :func:`load_figure`.
    """
    parameters = load_figure(path, scale)
    files = [value for _, value in parameters if isinstance(value, Path) and value.is_file()]
    digest = hashlib.sha256(repr(parameters).encode())
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]
