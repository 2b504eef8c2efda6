"""Series of samples: read from a table or YAML, predicted one by one, a row each."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError

from crackfront.analysis.estimate import Estimate
from crackfront.core.arguments import nearest_name
from crackfront.core.units import Scales
from crackfront.measured.options import (
    Energy,
    Force,
    Options,
    PredictionOptions,
    PsdOptions,
    ReadingOptions,
    SelfAffineOptions,
    SphereOptions,
    Text,
    checked_options,
    named_options,
    reading_options,
    sphere_scales,
)
from crackfront.measured.page.series import PREDICTED, SeriesPoint
from crackfront.measured.page.texts import sample_row
from crackfront.measured.prediction.prediction import Prediction, check_and_predict
from crackfront.measured.scan.psd import read_psd_file
from crackfront.measured.scan.scan_files import refuse_unreadable
from crackfront.measured.scan.text import decoded
from crackfront.measured.spectrum.measured_surface import read_surface
from crackfront.measured.spectrum.stated import Surface, density_surface, self_affine_surface_of
from crackfront.simulate.jsonable import to_jsonable

_YAML = {".yaml", ".yml"}

_HEAD = re.compile(r"\s*(?P<name>[^(\[]*?)\s*(?:[\[(](?P<unit>[^)\]]*)[\])])?\s*")
"""A name and its unit, as in `radius (mm)`."""

_BARE = re.compile(r"[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?")
"""A number without a unit."""

_NAMES = ("sample", "group")
"""Columns whose cells are names, also where they look like numbers."""

_NO_UNIT = {"", "1", "-"}
"""Units of numbers without a unit."""

_TWO_SIDES = re.compile(r"\d+,\d+")
"""Sides of a scan that are as well one with a decimal comma."""

_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2},\d{3}")
"""A number whose comma may separate thousands as well as decimals."""

_Row = tuple[int, dict[str, tuple[str, str]]]
"""Line of a row, and its cells with the units of their heads, by the names of their columns."""

_BETWEEN_FILES = re.compile(r"\s*[|;\n]\s*")

_FIRST = (
    *("sample", "group", "outcome", "failed", "undecided", "at_least", "none_expected"),
    *(f"{name}{end}" for name in PREDICTED for end in ("", "_low", "_high")),
    *(f"measured_{name}{end}" for name in PREDICTED for end in ("", "_error")),
)
"""First columns of a table of results."""

_MOST_SAMPLES = 10_000
"""Rows of a table; each takes seconds."""


def _listed(value: Any) -> tuple[str, ...]:
    """Files from a list, or from a text with | or ; between them."""
    given = value if isinstance(value, (list, tuple)) else _BETWEEN_FILES.split(str(value).strip())
    return tuple(str(one) for one in given if str(one))


class SampleOptions(Options):
    """What a row says of a sample beside options of reading, of its density and of the sphere."""

    sample: Text | None = None
    """Name of the sample."""

    group: Text | None = None
    """Group that it belongs to, with a marker of its own in the figure."""

    scans: Annotated[tuple[str, ...], BeforeValidator(_listed)] = ()
    """Its scans, with | between them; a * stands for any letters."""

    psd: Text | None = None
    """Its spectral density, in place of scans."""

    measured_hysteresis: Energy | None = None
    """Measured hysteresis, as in 25mJ/m2."""

    measured_w_appr: Energy | None = None
    """Measured work of adhesion of the approach."""

    measured_w_retr: Energy | None = None
    """Measured work of adhesion of the retraction."""

    measured_pull_off_force: Force | None = None
    """Measured pull-off force, as in 0.4mN."""

    measured_hysteresis_error: Energy | None = None
    """Standard error of the measured hysteresis; the others likewise."""

    measured_w_appr_error: Energy | None = None
    """Standard error of the measured w_appr."""

    measured_w_retr_error: Energy | None = None
    """Standard error of the measured w_retr."""

    measured_pull_off_force_error: Force | None = None
    """Standard error of the measured pull-off force."""


_RECORDS: tuple[type[Options], ...] = (
    SampleOptions,
    SphereOptions,
    ReadingOptions,
    PsdOptions,
    SelfAffineOptions,
    PredictionOptions,
)
"""Records whose fields are columns of a table."""


@dataclass(frozen=True, slots=True)
class Sample:
    """A sample of which everything is known that its prediction needs."""

    name: str
    group: str
    scans: tuple[Path, ...]
    psd: Path | None
    reading: tuple[ReadingOptions, ...]
    density: PsdOptions
    numbers: SelfAffineOptions
    scales: Scales
    given: PredictionOptions
    measured: Mapping[str, Estimate[float]]
    """Measured numbers by the names of predicted ones, in SI units."""


@dataclass(frozen=True, slots=True)
class SampleResult:
    """What came of a sample."""

    row: dict[str, Any]
    """Numbers in SI units and sentences, by the heads of their columns."""
    outcome: str
    prediction: Prediction | None
    sample: Sample

    def point(self, name: str) -> SeriesPoint:
        """A predicted number, and the measured one, for a figure."""
        nothing = Estimate(*[math.nan] * 4)
        found = nothing if self.prediction is None else getattr(self.prediction, name)
        return SeriesPoint(
            self.sample.name,
            self.sample.group,
            found,
            self.sample.measured.get(name, nothing),
            is_lower_bound=bool(self.row.get("at_least")),
        )


def read_samples(path: Path, common: Mapping[str, Any]) -> tuple[Sample, ...]:
    """Samples of a table, or of YAML, with options that hold where a row has none.

    ValueError, of one sentence with the line, where a row cannot be used or a file of it is absent,
    before any file is read; OSError if the table cannot be opened.
    """
    refuse_unreadable(path)
    rows = list(_yaml_rows(path) if path.suffix.lower() in _YAML else _table_rows(path))
    if not 0 < len(rows) <= _MOST_SAMPLES:
        raise ValueError(
            f"{path} has {len(rows)} samples; write a row for each, {_MOST_SAMPLES} at most"
        )
    found: dict[str, tuple[int, Sample]] = {}
    for line, row in rows:
        try:
            one = _sample(path.parent, row, common)
            if one.name in found:
                raise ValueError(
                    f"the sample {one.name!r} is in line {found[one.name][0]} as well; write "
                    "one row for each, with | between its scans"
                )
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}, line {line}: {error}") from error
        found[one.name] = line, one
    return tuple(one for _, one in found.values())


def scans_as_samples(
    scans: Sequence[Path],
    reading: Sequence[ReadingOptions],
    scales: Scales,
    given: PredictionOptions,
) -> tuple[Sample, ...]:
    """Every scan as a sample of its own, under one sphere."""
    return tuple(
        Sample(
            str(scan),
            "",
            (scan,),
            None,
            (by,),
            PsdOptions(),
            SelfAffineOptions(),
            scales,
            given,
            {},
        )
        for scan, by in zip(scans, reading, strict=True)
    )


def predicted_samples(samples: Sequence[Sample]) -> Iterator[SampleResult]:
    """Result of every sample; of one that cannot be used, the reason."""
    for one in samples:
        measured = {
            f"measured_{name}{end}": getattr(value, field)
            for name, value in one.measured.items()
            for end, field in (("", "value"), ("_error", "standard_error"))
            if math.isfinite(getattr(value, field))
        }
        head = {"sample": one.name, "group": one.group}
        prediction = None
        try:
            surface = _surface(one)
            verdict, prediction = check_and_predict(surface, one.scales, one.given)
            row = sample_row(surface, one.scales, verdict, prediction)
        except (ValueError, OSError) as error:
            row = {"outcome": "refused", "remarks": str(error)}
        found = head | row | measured
        order = [name for name in _FIRST if name in found]
        found = {name: found[name] for name in (*order, *(x for x in found if x not in order))}
        yield SampleResult(to_jsonable(found), str(row["outcome"]), prediction, one)


def _surface(one: Sample) -> Surface:
    """Surface of a sample."""
    if one.scans:
        return read_surface(one.scans, one.reading)
    if one.psd is not None:
        return density_surface(read_psd_file(one.psd, one.density))
    return self_affine_surface_of(one.numbers)


def _sample(folder: Path, row: Mapping[str, Any], common: Mapping[str, Any]) -> Sample:
    """Sample of a row; relative paths begin in the folder of the table."""
    known = [name for record in _RECORDS for name in record.model_fields]
    for name in row:
        if name not in known:
            hint = nearest_name(name, known, "the columns are")
            raise ValueError(f"there is no column {name!r}; {hint}")
    if "mask" in row:
        row = {**row, "mask": _masks(folder, row["mask"])}
    given = {**common, **row}
    own = checked_options(SampleOptions, given)
    if own.sample is None:
        raise ValueError("there is no name; write it in the column 'sample'")
    numbers = checked_options(SelfAffineOptions, row)
    is_stated = bool(named_options(SelfAffineOptions, row))
    ways = {"scans": bool(own.scans), "psd": own.psd is not None, "rms": is_stated}
    if sum(ways.values()) != 1:
        named = " and ".join(name for name, is_named in ways.items() if is_named) or "nothing"
        raise ValueError(f"the surface is given by {named}; name its scans, or its psd, or its rms")
    if is_stated:
        self_affine_surface_of(numbers)
    if not own.scans:
        _refuse_without_effect(ReadingOptions, "scans", row, common)
    if own.psd is None:
        _refuse_without_effect(PsdOptions, "psd", row, common)
    scans = tuple(file for name in own.scans for file in _files(folder, name))
    psd = None if own.psd is None else _file(folder, own.psd)
    fields = [name for name in PREDICTED if name != "e_el"]
    return Sample(
        name=own.sample,
        group=own.group or "",
        scans=scans,
        psd=psd,
        reading=tuple(reading_options(_reading(given), len(scans))),
        density=checked_options(PsdOptions, given),
        numbers=numbers,
        scales=sphere_scales(checked_options(SphereOptions, given)),
        given=checked_options(PredictionOptions, given),
        measured={
            name: _with_error(value, getattr(own, f"measured_{name}_error"))
            for name in fields
            if (value := getattr(own, f"measured_{name}")) is not None
        },
    )


def _refuse_without_effect(
    record: type[Options], way: str, row: Mapping[str, Any], common: Mapping[str, Any]
) -> None:
    """Raise at an option of scans, or of a density, of a sample that is given in another way."""
    for name in named_options(record, {**common, **row}):
        advice = "leave it out" if name in row else f"write it in a column, for rows with {way}"
        raise ValueError(f"{name} is an option of {way}, and the sample has none; {advice}")


def _reading(given: Mapping[str, Any]) -> dict[str, Any]:
    """Options of reading, without those that are empty."""
    return {name: one for name, one in given.items() if one not in (None, ())}


def _with_error(value: float, error: float | None) -> Estimate[float]:
    """A measured number; its interval is two standard errors to both sides."""
    if error is None:
        return Estimate(value, math.nan, math.nan, math.nan)
    return Estimate(value, error, value - 2 * error, value + 2 * error)


def _files(folder: Path, name: str) -> list[Path]:
    """Files of a name, or of a pattern; ValueError where there are none."""
    path = folder / name
    found = [path] if path.exists() else []
    if not found and "*" in name:
        found = sorted(path.parent.glob(path.name))
    if not found:
        raise ValueError(f"there is no file {path}; correct its name, relative to the table")
    return found


def _file(folder: Path, name: str) -> Path:
    """File of a name, or the only one of a pattern; ValueError where there are none or several."""
    found = _files(folder, name)
    if len(found) > 1:
        listed = ", ".join(one.name for one in found[:3]) + ", ..." * (len(found) > 3)
        raise ValueError(f"{name} stands for {len(found)} files, {listed}; name one of them")
    return found[0]


def _masks(folder: Path, given: Any) -> list[Any]:
    """Parts of a scan as they are, which have colons, and files relative to the table."""
    masks = given if isinstance(given, list) else [given]
    return [_file(folder, one) if isinstance(one, str) and ":" not in one else one for one in masks]


def _table_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Line and content of every row of a text with heads."""
    text = decoded(path)
    if text is None:
        raise ValueError(f"{path} is no text; export the table as CSV")
    lines = text.split("\n")
    first = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    between = max("\t;,", key=first.count)
    rows = list(_cells(path, lines, between))
    if between != ",":
        _refuse_other_numbers(path, rows)
    for line, row in rows:
        yield (
            line,
            {
                name: cell if name in _NAMES else _with_unit(cell, unit, between)
                for name, (cell, unit) in row.items()
                if cell
            },
        )


def _cells(path: Path, lines: Sequence[str], between: str) -> Iterator[_Row]:
    """Line of every row, and its cells with the units of their heads."""
    reader = csv.reader(lines, delimiter=between)
    heads: list[tuple[str, str]] = []
    for cells in reader:
        cells = [cell.strip() for cell in cells]
        if not any(cells) or cells[0].startswith("#"):
            continue
        where = f"{path}, line {reader.line_num}"
        if not heads:
            heads = [_head(cell, where) for cell in cells]
            names = [name for name, _ in heads if name]
            if twice := next((name for name in names if names.count(name) > 1), None):
                raise ValueError(f"{where}: two columns are called {twice!r}")
            continue
        if len(cells) > len(heads) and any(cells[len(heads) :]):
            raise ValueError(
                f"{where}: the row has {len(cells)} cells and the heads are "
                f"{len(heads)}; write {between!r} between cells alone, or quotes around them"
            )
        yield (
            reader.line_num,
            {name: (cell, unit) for (name, unit), cell in zip(heads, cells, strict=False) if name},
        )


def _refuse_other_numbers(path: Path, rows: Sequence[_Row]) -> None:
    """Raise where numbers have two decimal signs, or commas that may all separate thousands."""
    numbers = list(_numbers(path, rows))
    signs: set[str] = set()
    for where, _, cell in numbers:
        signs |= {sign for sign in ",." if sign in cell}
        if len(signs) > 1:
            raise ValueError(
                f"{where}: the table has numbers with decimal points and with decimal commas; "
                "write one of them"
            )
    with_comma = [one for one in numbers if "," in one[-1]]
    if with_comma and all(_THOUSANDS.fullmatch(cell) for *_, cell in with_comma):
        where, name, cell = with_comma[0]
        raise ValueError(
            f"{where}: {name} is {cell!r}, whose comma may separate thousands or decimals; write "
            f"{cell.replace(',', '')!r}, or '{cell}0' if it separates decimals"
        )


def _numbers(path: Path, rows: Sequence[_Row]) -> Iterator[tuple[str, str, str]]:
    """Place, name of the column and cell of all numbers but those of names and of sides."""
    for line, row in rows:
        where = f"{path}, line {line}"
        size, _ = row.get("size", ("", ""))
        if _TWO_SIDES.fullmatch(size):
            raise ValueError(
                f"{where}: size is {size!r}, one side or two; write {size.replace(',', ', ')!r} "
                f"for two sides, or {size.replace(',', '.')!r} for one"
            )
        for name, (cell, _) in row.items():
            if name not in (*_NAMES, "size") and _BARE.fullmatch(cell):
                yield where, name, cell


def _head(cell: str, where: str) -> tuple[str, str]:
    """Name and unit in the head of a column, refused where a number is part of the unit."""
    found = _HEAD.fullmatch(cell)
    name, unit = (found["name"], (found["unit"] or "").strip()) if found else (cell, "")
    if unit in _NO_UNIT:
        unit = ""
    elif re.match(r"[-+.,]?\d", unit):
        raise ValueError(
            f"{where}: the unit of the column {name!r} is {unit!r}, which begins with a number; "
            "write a unit alone, as in mJ/m2, and the cells in it"
        )
    return re.sub(r"[\s-]+", "_", name.strip().lower()), unit


def _with_unit(cell: str, unit: str, between: str) -> str:
    """A cell with the unit of its head, and a point for decimals."""
    if _BARE.fullmatch(cell) is None:
        return cell
    value = cell if between == "," else cell.replace(",", ".")
    return value + unit


def _yaml_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Line and content of every sample of a YAML file."""
    try:
        content = YAML(typ="rt").load(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is no text in UTF-8; store it as such") from error
    except MarkedYAMLError as error:
        where = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        raise ValueError(f"{path}{where}: this is no YAML: {error.problem}; correct it") from error
    rows = content.get("samples") if isinstance(content, dict) else content
    others = [name for name in content if name != "samples"] if isinstance(content, dict) else []
    if rows is not None and others:
        raise ValueError(f"{path} has {str(others[0])!r} beside samples; remove it")
    if not isinstance(rows, list) or not all(isinstance(one, dict) for one in rows):
        raise ValueError(
            f"{path} has no list of samples; write 'samples:' with '- sample: A' below"
        )
    for row in rows:
        where = f"{path}, line {row.lc.line + 1}"
        cells = {_head(str(name), where): value for name, value in row.items() if value is not None}
        yield (
            row.lc.line + 1,
            {
                name: list(value) if isinstance(value, list) else _with_unit(str(value), unit, ",")
                for (name, unit), value in cells.items()
            },
        )
