"""The law of k held to simulated spheres, to which none of its numbers is adjusted."""

import numpy as np
import pytest

from crackfront.analysis.csv_records import csv_text
from crackfront.analysis.law import pinning_factor
from crackfront.core.adhesion import correlation_length
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.sweep.parameters import load_sweep
from studies.law.cells import HELD_OUT as HELD_OUT_SHAPES
from studies.law.cells import measured_cells
from studies.law.spheres import is_covered, is_within, law_of, read_spheres
from tests.places import ROOT

REFERENCE = ROOT / "docs/reference/spheres.csv"
HELD_OUT = ROOT / "docs/reference/held-out.csv"


@pytest.fixture(scope="module")
def spheres():
    return read_spheres([REFERENCE])


def test_the_reference_holds_the_sweeps_that_it_is_made_from(spheres):
    sweep = load_sweep(ROOT / "config/spheres.yaml")
    assert len(spheres) == len(sweep.spectra) * len(sweep.elastic_energies)
    for item in sweep.spectra:
        shape = item.spectrum
        for energy in sweep.elastic_energies:
            [row] = [
                row
                for row in spheres
                if row.spectrum == item.name
                and row.elastic_energy == pytest.approx(energy, rel=0.03)
            ]
            spectrum = SelfAffineSpectrum(row.short_cutoff, row.roll_off, row.hurst)
            expected = correlation_length(sweep.kind, shape)
            assert correlation_length(sweep.kind, spectrum) == pytest.approx(expected, rel=1e-4)
            assert row.kind == sweep.kind
            assert 0.8 * sweep.n_realisation < row.realisations <= sweep.n_realisation


def test_a_table_of_spheres_is_read_as_it_was_written(spheres, tmp_path):
    path = tmp_path / "spheres.csv"
    path.write_text(csv_text(spheres))
    assert read_spheres([path]) == spheres
    assert path.read_text() == REFERENCE.read_text()


@pytest.mark.parametrize(
    ("path", "rms", "worst"), [(HELD_OUT, 0.025, 0.06), (REFERENCE, 0.03, 0.07)]
)
def test_the_line_alone_predicts_spheres_with_intervals_that_cover_and_are_narrow(path, rms, worst):
    held = [(row, law) for row in read_spheres([path]) if (law := law_of(row)).size > 1]
    assert len(held) >= 25
    half = [(law.both.high - law.both.low) / 2 / law.both.value for _, law in held]
    assert np.median(half) < 0.06
    deviations = np.array([law.both.value / row.both - 1 for row, law in held])
    assert np.sqrt(np.mean(deviations**2)) < rms
    assert np.max(np.abs(deviations)) < worst
    outside = [
        f"{row.spectrum} {row.elastic_energy:.3g}: {row.both:.3f}, law {law.both.value:.3f}"
        for row, law in held
        if not is_covered(row, law)
    ]
    # A twentieth may lie outside of 95% intervals.
    assert len(outside) <= len(held) / 20, outside


@pytest.mark.parametrize("name", HELD_OUT_SHAPES)
def test_shapes_without_a_part_in_the_fit_are_predicted(name):
    cells = [cell for cell in measured_cells() if cell.spectrum == name and cell.size > 1]
    assert len(cells) >= 6
    laws = [pinning_factor(cell.disorder, cell.size, breadth=cell.breadth).factor for cell in cells]
    deviations = np.array(
        [law.value / cell.both - 1 for law, cell in zip(laws, cells, strict=True)]
    )
    assert np.sqrt(np.mean(deviations**2)) < 0.025
    assert np.max(np.abs(deviations)) < 0.06
    covered = [is_within(cell.both, cell.error, law) for law, cell in zip(laws, cells, strict=True)]
    assert np.mean(covered) > 0.85
