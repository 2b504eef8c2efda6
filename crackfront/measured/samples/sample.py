"""Samples of a series: what a row of a table says of each, checked before any file is read."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import BeforeValidator, ValidationInfo

from crackfront.analysis.estimate import UNKNOWN, Estimate
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
    quantity,
    reading_options,
    sphere_scales,
)
from crackfront.measured.page.series import PREDICTED
from crackfront.measured.samples.sample_rows import SampleRow, sample_rows
from crackfront.measured.spectrum.stated import self_affine_surface_of
from crackfront.surfaces.written_units import is_unit

_BETWEEN_FILES = re.compile(r"[|;\n]")

_ZERO = re.compile(r"\+?0*\.?0+\.?(?:[eE][-+]?\d+)?\s*([^\s\d.].*)?")
"""Zero with an optional unit."""

_Validator = Callable[[Any, ValidationInfo], float]

_LIKE_AN_OPTION = 0.8
"""Similarity of a heading with the name of an option from which it is taken for a misprint."""

_MOST_SAMPLES = 10_000
"""Rows of a table; each takes seconds."""


def _listed(value: Any) -> tuple[str, ...]:
    """Files from a list, or from a text with | or ; between them."""
    names = value if isinstance(value, (list, tuple)) else _BETWEEN_FILES.split(str(value))
    return tuple(name for name in map(str.strip, map(str, names)) if name)


def _measured_quantity(unit: str, name: str, example: str) -> BeforeValidator:
    """Validator of measured quantities, which scatter around zero where the true one is small."""
    positive = cast(_Validator, quantity(unit, name, example).func)

    def checked(value: Any, info: ValidationInfo) -> float:
        if not isinstance(value, str):
            return positive(value, info)
        text = value.strip()
        sign = -1 if text.startswith(("-", "\u2212")) else 1
        text = text[1:].lstrip() if sign < 0 else text
        zero = _ZERO.fullmatch(text)
        if zero and (not zero[1] or is_unit(zero[1], unit)):
            return 0.0
        return sign * positive(text, info)

    return BeforeValidator(checked)


MeasuredEnergy = Annotated[float, _measured_quantity("J/m^2", "energy per area", "-3mJ/m2")]
MeasuredForce = Annotated[float, _measured_quantity("N", "force", "0.4mN")]


class SampleOptions(Options):
    """What a row says of a sample, next to options of reading, of its density and of the sphere."""

    sample: Text | None = None
    """Name of the sample."""

    group: Text | None = None
    """Group that it belongs to, with a marker of its own in the figure."""

    scans: Annotated[tuple[str, ...], BeforeValidator(_listed)] = ()
    """Its scans, with | between them; a * stands for any letters."""

    psd: Text | None = None
    """Its spectral density, in place of scans."""

    measured_hysteresis: MeasuredEnergy | None = None
    """Measured hysteresis, as in 25mJ/m2."""

    measured_w_appr: MeasuredEnergy | None = None
    """Measured work of adhesion of the approach."""

    measured_w_retr: MeasuredEnergy | None = None
    """Measured work of adhesion of the retraction."""

    measured_pull_off_force: MeasuredForce | None = None
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

_COLUMNS = tuple(name for record in _RECORDS for name in record.model_fields)
"""Columns that are read; others are copied to the results."""


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
    theory: PredictionOptions
    measured: Mapping[str, Estimate[float]]
    """Measured numbers by the names of predicted ones, in SI units."""
    further: Mapping[str, str]
    """Cells of columns that are not read, by their headings."""


def read_samples(path: Path, common: Mapping[str, Any]) -> tuple[Sample, ...]:
    """Samples of a table, or of YAML, with options for rows that have none.

    ValueError, of one sentence with the line, where a row cannot be used or a file of it is absent,
    before any file is read; OSError if the table cannot be opened.
    """
    rows = sample_rows(path, _COLUMNS)
    if not 0 < len(rows) <= _MOST_SAMPLES:
        raise ValueError(
            f"{path} has {len(rows)} samples; write a row for each, {_MOST_SAMPLES} at most"
        )
    samples: dict[str, Sample] = {}
    lines: dict[str, int] = {}
    for row in rows:
        line = row.line
        try:
            sample = _sample(path.parent, row, common)
            if sample.name in samples:
                raise ValueError(
                    f"the sample {sample.name!r} is in line {lines[sample.name]} as well; write "
                    "one row for each, with | between its scans"
                )
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}, line {line}: {error}") from error
        samples[sample.name] = sample
        lines[sample.name] = line
    return tuple(samples.values())


def scans_as_samples(
    scans: Sequence[Path],
    reading: Sequence[ReadingOptions],
    scales: Scales,
    theory: PredictionOptions,
) -> tuple[Sample, ...]:
    """Every scan as a sample of its own, under one sphere."""
    return tuple(
        Sample(
            name=str(scan),
            group="",
            scans=(scan,),
            psd=None,
            reading=(options,),
            density=PsdOptions(),
            numbers=SelfAffineOptions(),
            scales=scales,
            theory=theory,
            measured={},
            further={},
        )
        for scan, options in zip(scans, reading, strict=True)
    )


def _sample(folder: Path, sample_row: SampleRow, common: Mapping[str, Any]) -> Sample:
    """Sample of a row; relative paths begin in the folder of the table."""
    _check_columns(sample_row)
    row = sample_row.options
    if "mask" in row:
        row = {**row, "mask": _masks(folder, row["mask"])}
    options = {**common, **row}
    values = checked_options(SampleOptions, options)
    if values.sample is None:
        raise ValueError("the name is missing; write it in the column 'sample'")
    numbers = checked_options(SelfAffineOptions, row)
    _check_single_surface(values, row)
    if named_options(SelfAffineOptions, row):
        self_affine_surface_of(numbers)
    if not values.scans:
        _check_effect(ReadingOptions, "scans", row, common)
    if values.psd is None:
        _check_effect(PsdOptions, "psd", row, common)
    scans = tuple(file for name in values.scans for file in _files(folder, name))
    return Sample(
        name=values.sample,
        group=values.group or "",
        scans=scans,
        psd=None if values.psd is None else _file(folder, values.psd),
        reading=tuple(reading_options(options, len(scans))),
        density=checked_options(PsdOptions, options),
        numbers=numbers,
        scales=sphere_scales(checked_options(SphereOptions, options)),
        theory=checked_options(PredictionOptions, options),
        measured=_measured(values),
        further=sample_row.further,
    )


def _check_columns(row: SampleRow) -> None:
    """Raise at a column that seems to be a misprint of an option."""
    for heading in row.further:
        name = re.sub(r"\W+", "_", heading.lower())
        near = difflib.get_close_matches(name, _COLUMNS, n=1, cutoff=_LIKE_AN_OPTION)
        if near:
            raise ValueError(
                f"the column {heading!r} is unknown; did you mean {near[0]}? If it is to be copied "
                "to the results, choose a name that is less like it"
            )


def _check_single_surface(values: SampleOptions, row: Mapping[str, Any]) -> None:
    """Raise unless a row has exactly one of scans, density and numbers."""
    ways = {
        "scans": bool(values.scans),
        "psd": values.psd is not None,
        "rms": bool(named_options(SelfAffineOptions, row)),
    }
    if sum(ways.values()) != 1:
        present = " and ".join(name for name, is_named in ways.items() if is_named) or "nothing"
        raise ValueError(
            f"the surface is given by {present}; name its scans, or its psd, or its rms"
        )


def _check_effect(
    record: type[Options], way: str, row: Mapping[str, Any], common: Mapping[str, Any]
) -> None:
    """Raise at an option of scans, or of a density, of a sample that is given in another way."""
    for name in named_options(record, {**common, **row}):
        advice = "leave it out" if name in row else f"write it in a column, for rows with {way}"
        raise ValueError(f"{name} is an option of {way}, and the sample has none; {advice}")


def _measured(values: SampleOptions) -> dict[str, Estimate[float]]:
    """Measured numbers of a row; their intervals are two standard errors to both sides."""
    measured = {}
    for name in PREDICTED:
        value = getattr(values, f"measured_{name}", None)
        error = getattr(values, f"measured_{name}_error", None)
        if value is not None and error is not None:
            measured[name] = Estimate(value, error, value - 2 * error, value + 2 * error)
        elif value is not None:
            measured[name] = replace(UNKNOWN, value=value)
    return measured


def _files(folder: Path, name: str) -> list[Path]:
    """Files of a name, or of a pattern; ValueError if there are none."""
    path = folder / name
    if path.exists():
        return [path]
    files = sorted(path.parent.glob(path.name)) if "*" in name else []
    if not files:
        raise ValueError(f"{path} does not exist; correct its name, relative to the table")
    return files


def _file(folder: Path, name: str) -> Path:
    """File of a name, or the only one of a pattern; ValueError if there are none or several."""
    files = _files(folder, name)
    if len(files) > 1:
        names = [file.name for file in files[:3]] + (["..."] if len(files) > 3 else [])
        raise ValueError(
            f"{name} stands for {len(files)} files, {', '.join(names)}; name one of them"
        )
    return files[0]


def _masks(folder: Path, masks: Any) -> list[Any]:
    """Parts of a scan as they are, which have colons, and files relative to the table."""
    return [
        _file(folder, mask) if isinstance(mask, str) and ":" not in mask else mask
        for mask in (masks if isinstance(masks, list) else [masks])
    ]
