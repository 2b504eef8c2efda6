"""Predictions for a series of samples, a row each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from crackfront.analysis.estimate import UNKNOWN
from crackfront.measured.page.series import PREDICTED, SeriesPoint
from crackfront.measured.page.texts import sample_row
from crackfront.measured.prediction.prediction import (
    Prediction,
    check_and_predict,
    not_predicted,
)
from crackfront.measured.samples.sample import Sample
from crackfront.measured.scan.psd import read_psd_file
from crackfront.measured.spectrum.measured_surface import read_surface
from crackfront.measured.spectrum.stated import Surface, density_surface, self_affine_surface_of
from crackfront.simulate.jsonable import to_jsonable

_FIRST = (
    *("sample", "group", "outcome", "failed", "undecided", "at_least", "none_expected"),
    *(f"{name}{end}" for name in PREDICTED for end in ("", "_low", "_high")),
    *(f"measured_{name}{end}" for name in PREDICTED for end in ("", "_error")),
)
"""First columns of a table of results."""

_RESULTS = (*_FIRST, "remarks", "e_el")
"""Columns of results, which columns of the user cannot have the names of."""


@dataclass(frozen=True, slots=True)
class SampleResult:
    """What came of a sample."""

    row: dict[str, Any]
    """Numbers in SI units and sentences, by the names of their columns."""
    outcome: str
    prediction: Prediction | None
    """Its numbers but e_el are NaN if the theory does not apply; None if a file failed."""
    sample: Sample

    def point(self, name: str) -> SeriesPoint:
        """A predicted number, and the measured one, for a figure."""
        predicted = UNKNOWN if self.prediction is None else getattr(self.prediction, name)
        return SeriesPoint(
            self.sample.name,
            self.sample.group,
            predicted,
            self.sample.measured.get(name, UNKNOWN),
            is_lower_bound=bool(self.row.get("at_least")),
        )


def predicted_samples(samples: Sequence[Sample]) -> Iterator[SampleResult]:
    """Result of every sample; of one that cannot be used, the reason."""
    for sample in samples:
        prediction = None
        try:
            surface = _surface(sample)
            verdict, prediction = check_and_predict(surface, sample.scales, sample.theory)
            row = sample_row(surface, sample.scales, verdict, prediction)
            if prediction is None:
                prediction = not_predicted(surface, sample.scales, verdict)
        except (ValueError, OSError) as error:
            row = {"outcome": "invalid", "remarks": str(error)}
        row = {"sample": sample.name, "group": sample.group} | row | _measured_cells(sample)
        row |= {
            f"{name} (table)" if name in row or name in _RESULTS else name: cell
            for name, cell in sample.further.items()
        }
        first = {name: row[name] for name in _FIRST if name in row}
        yield SampleResult(to_jsonable(first | row), str(row["outcome"]), prediction, sample)


def _measured_cells(sample: Sample) -> dict[str, float]:
    """Measured numbers of a sample and their errors, where there are any."""
    cells = {}
    for name, estimate in sample.measured.items():
        cells[f"measured_{name}"] = estimate.value
        if math.isfinite(estimate.standard_error):
            cells[f"measured_{name}_error"] = estimate.standard_error
    return cells


def _surface(sample: Sample) -> Surface:
    """Surface of a sample."""
    if sample.scans:
        return read_surface(sample.scans, sample.reading)
    if sample.psd is not None:
        return density_surface(read_psd_file(sample.psd, sample.density))
    return self_affine_surface_of(sample.numbers)
