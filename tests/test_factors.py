"""The factors k of surfaces that were not simulated, and the table that they rest on."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.factors import factors_text, rows
from crackfront.analysis.factors import (
    BRANCHES,
    expected_factors,
    leave_one_out_error,
    measured_factors,
)
from crackfront.analysis.table import SweepTable
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.sweep.configuration import load_configuration

CONFIG = Path(__file__).parents[1] / "config"
RADIUS = 1.8656
FLAT = SelfAffineSpectrum(0.01, 0.01, 1.0)


def table(rng, shape=(2, 3, 4)):
    """A sweep whose branches have k = 2 and k = 3 exactly."""
    energy = np.array([0.02, 0.05, 0.1])[:, None] * rng.uniform(0.9, 1.1, shape)
    nan = np.full(shape, 1e-4)
    lengths = np.array([0.01, 0.02])
    return SweepTable(
        spectrum=np.array(["a", "b"]),
        short_cutoff=lengths,
        roll_off=2 * lengths,
        hurst=np.array([0.8, 0.8]),
        correlation_length=1.5 * lengths,
        e_el_requested=np.array([0.02, 0.05, 0.1]),
        e_el=energy,
        w_rms=2 * np.sqrt(energy),
        w_appr=1 - 3 * energy,
        w_retr=1 + 2 * energy,
        w_appr_from_force=nan,
        w_retr_from_force=nan,
        w_appr_numerical_error=nan,
        w_retr_numerical_error=nan,
        contact_radius=np.full(shape, RADIUS),
        spring=np.full(shape[:2], np.nan),
    )


def test_the_rows_of_a_sweep_are_the_factors_of_its_branches(rng):
    found = list(rows(table(rng), RADIUS))
    assert len(found) == 6
    for row in found:
        assert (row.approach, row.retraction, row.both) == pytest.approx((2, 3, 2.5))
        assert row.both_error == pytest.approx(0, abs=1e-12)
        assert row.realisations == 4
    assert found[3].spectrum == "b"
    assert found[3].elastic_energy == pytest.approx(0.02, rel=0.1)


def test_a_failed_simulation_is_left_out_of_the_rows(rng):
    sweep = table(rng)
    sweep.w_retr[0, 0, 0] = np.nan
    first = next(rows(sweep, RADIUS))
    assert first.realisations == 3
    assert first.retraction == pytest.approx(3)


def test_the_table_keeps_five_digits_of_the_rows(rng):
    lines = factors_text(list(rows(table(rng), RADIUS))).splitlines()
    assert lines[0].startswith("spectrum,short_cutoff,roll_off,hurst,correlation_length")
    assert lines[1].split(",")[8:14:2] == ["2", "3", "2.5"]


def test_the_table_holds_the_sweeps_that_it_is_made_from():
    sweeps = [load_configuration(CONFIG / f"{name}.yaml") for name in ("default", "strong")]
    found = {
        (row.spectrum, row.short_cutoff, row.roll_off, round(row.elastic_energy, 4))
        for row in measured_factors()
    }
    assert len(found) == sum(len(sweep.spectra) * len(sweep.elastic_energies) for sweep in sweeps)
    for sweep in sweeps:
        for item in sweep.spectra:
            for energy in sweep.elastic_energies:
                lengths = item.spectrum.short_cutoff, item.spectrum.roll_off
                assert any(
                    name == item.name
                    and (short, long) == pytest.approx(lengths)
                    and known == pytest.approx(energy, rel=0.03)
                    for name, short, long, known in found
                )


def test_a_measured_surface_has_its_own_factors():
    for row in measured_factors():
        shape = SelfAffineSpectrum(row.short_cutoff, row.roll_off, row.hurst)
        found = expected_factors(shape, row.elastic_energy, row.contact_radius)
        assert found.spectra[0] == row.spectrum
        assert found.weights[0] == pytest.approx(1, abs=1e-6)
        for branch in BRANCHES:
            factor = getattr(found, branch)
            assert factor.value == pytest.approx(getattr(row, branch), abs=1e-4)
            assert factor.low < factor.value < factor.high


def test_an_interval_covers_every_spectrum_that_the_table_does_without():
    """The width comes from the errors of leaving one out; none may be far outside of it."""
    for energy in (0.005, 0.02, 0.05, 0.1, 0.15, 0.25, 0.4):
        found = expected_factors(FLAT, energy, RADIUS).both
        reach = found.high - found.value
        error = leave_one_out_error(energy, "both")
        assert 1.9 * error < reach < 3.5 * error + 0.1
        assert error < 0.4


def test_factors_fall_with_size_and_with_disorder():
    small, large = (
        expected_factors(SelfAffineSpectrum(length, length, 1.0), 0.02, RADIUS).both.value
        for length in (0.006, 0.014)
    )
    assert small > large + 0.2
    weak, strong = (expected_factors(FLAT, energy, RADIUS).both.value for energy in (0.05, 0.4))
    assert weak > strong + 0.5


def test_below_the_weakest_disorder_there_may_be_no_hysteresis():
    found = expected_factors(FLAT, 1e-4, RADIUS)
    assert found.near_onset
    assert found.amplitude_octaves == pytest.approx(math.log2(1e-4 / 0.002), abs=0.05)
    assert all(getattr(found, branch).low == 0 for branch in BRANCHES)
    assert found.both.high > 0.5


def test_above_the_strongest_disorder_the_interval_widens():
    inside, outside = (expected_factors(FLAT, energy, RADIUS) for energy in (0.39, 0.8))
    assert outside.amplitude_octaves == pytest.approx(1, abs=0.05)
    assert inside.amplitude_octaves == 0
    assert outside.both.value == pytest.approx(inside.both.value, abs=0.05)
    assert outside.both.high - outside.both.low > 1.5 * (inside.both.high - inside.both.low)
    assert not outside.near_onset


def test_factors_follow_the_trend_of_size_beyond_the_table():
    lengths = 0.02, 0.04, 0.08
    inside, twice, more = (
        expected_factors(SelfAffineSpectrum(0.75 * length, 0.75 * length, 1.0), 0.1, RADIUS).both
        for length in lengths
    )
    assert inside.value > twice.value > more.value > 1
    assert twice.value - more.value == pytest.approx(inside.value - twice.value, abs=0.05)
    assert more.high - more.low > inside.high - inside.low + 2 * (twice.value - more.value)


def test_no_factor_exceeds_that_of_perturbation_theory():
    tiny = SelfAffineSpectrum(1e-5, 1e-5, 1.0)
    found = expected_factors(tiny, 0.005, RADIUS).both
    assert found.value == found.high == 4
    assert expected_factors(tiny, 0.005, RADIUS).both.low < 3


def test_sizes_outside_of_the_table_are_told():
    long, short = (
        expected_factors(SelfAffineSpectrum(length, length, 1.0), 0.1, RADIUS).size_octaves
        for length in (0.12, 0.0005)
    )
    assert long == pytest.approx(3, abs=0.01)
    assert short < -3


@pytest.mark.parametrize("energy", [0.0, 1.0, 2.0, math.nan])
def test_an_energy_without_full_conformity_is_refused(energy):
    with pytest.raises(ValueError, match="need one between 0 and 1"):
        expected_factors(FLAT, energy, RADIUS)
