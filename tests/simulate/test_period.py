"""Straight fronts of a sweep: exact averages over a tile, symmetry, sizes, bad input."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.analysis.steady_adhesion import period_adhesion
from crackfront.cli import main
from crackfront.core.adhesion import correlation_length, larkin_length
from crackfront.core.cycle.record import Recorder
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.contact import Problem
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.simulation import simulation_adhesion, simulation_field
from crackfront.sweep.parameters import load_sweep

CONFIGURATION = Path(__file__).parents[1] / "line-test.yaml"
TEXT = CONFIGURATION.read_text(encoding="utf-8")
SWEEP = load_sweep(CONFIGURATION)
ONE = SWEEP.simulation(SWEEP.spectra[1], 0.04, 0)
SHAPES = {
    "flat": ("roughness", SelfAffineSpectrum(1.0, 1.0, 1.0)),
    "h08": ("roughness", SelfAffineSpectrum(1.0, 6.0, 0.8)),
    "h03": ("roughness", SelfAffineSpectrum(1.0, 6.0, 0.3)),
    "chemical": ("chemical", SelfAffineSpectrum(1.0, 3.0, 0.5)),
}


def longer(simulation, periods):
    """A simulation that is pulled over several periods of its tile before the last."""
    schedule = simulation.schedule
    lead_in = schedule.lead_in + periods * schedule.period
    return replace(simulation, schedule=replace(schedule, lead_in=lead_in))


def run(simulation, adhesion=None):
    """Record with its fronts, of a tile that may be another than the simulation's own."""
    adhesion = simulation_adhesion(simulation) if adhesion is None else adhesion
    field = simulation_field(simulation, adhesion)
    problem = Problem(field, simulation.correlation_length, simulation.elastic_energy)
    return simulation.schedule.run(problem, SOLVERS["newton"](1e-10), Recorder(fronts=True))


@pytest.mark.parametrize("energy", [0.04, 0.16])
def test_after_the_lead_in_a_period_later_the_front_is_the_same_further_on(energy):
    simulation = longer(SWEEP.simulation(SWEEP.spectra[1], energy, 0), 1)
    record, schedule = run(simulation), simulation.schedule
    for direction in (1, -1):
        fronts = record.fronts[direction * record.states.direction > 0]
        n_period = schedule.n_period
        last, before = fronts[-n_period:], fronts[-2 * n_period : -n_period]
        assert len(before) == n_period
        # The first of two periods may begin anywhere within the tolerance, and soft sites differ by
        # more than that.
        assert np.max(np.abs(last - before - direction * schedule.period)) < 2e-9


def test_a_front_begins_within_its_field_however_long_the_steps_are():
    weak = SWEEP.simulation(SWEEP.spectra[0], 0.0025, 0)
    period = weak.schedule.period
    coarse = run(replace(weak, schedule=replace(weak.schedule, step=period)))
    fine = run(weak)
    assert coarse.status is Status.STEADY
    for direction in (1, -1):
        short_steps, long_steps = (
            record.fronts[
                (record.states.direction == direction)
                & np.isclose(record.states.spring_position, period)
            ][0]
            for record in (coarse, fine)
        )
        np.testing.assert_allclose(short_steps, long_steps, atol=1e-5)


def test_the_mirrored_surface_with_the_opposite_sign_swaps_the_branches():
    adhesion, resolution = simulation_adhesion(ONE), ONE.resolution
    values, pixel = adhesion.work_of_adhesion, adhesion.pixel
    # Loads, samples and their mirror images are multiples of half a pixel.
    plain = replace(ONE, resolution=replace(resolution, spacing=pixel / 2))
    last = float(plain.schedule.loads[-1]) / pixel
    assert last == pytest.approx(round(last), abs=1e-9)
    places = (round(last) - np.arange(len(values))) % len(values)
    mirrored = replace(adhesion, work_of_adhesion=(2 * values.mean() - values)[places])
    original, opposite = (
        period_adhesion(run(plain, item), plain.schedule.n_period, 1.0, 1.0)
        for item in (adhesion, mirrored)
    )
    assert original.w_appr - 1 == pytest.approx(1 - opposite.w_retr, rel=1e-9)
    assert original.w_retr - 1 == pytest.approx(1 - opposite.w_appr, rel=1e-9)


def of_shape(shape, schedule, **sizes):
    """A simulation of a shape of spectrum under loads of its own, with a tile of such sizes."""
    kind, spectrum = SHAPES[shape]
    resolution = replace(ONE.resolution, **sizes)
    return replace(ONE, kind=kind, spectrum=spectrum, schedule=schedule, resolution=resolution)


@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_second_order_of_the_tile_is_that_of_the_spectrum(shape):
    # f_2 = (1 / 2 pi w_int) int q C_w(q) dq = w_rms^2 / w_int, of a large tile.
    schedule = LineSchedule(spring=4.0, length=240.0, period=120.0, lead_in=3.0, step=0.5)
    wanted = of_shape(shape, schedule, tile_side=240.0, n_point=720)
    adhesion = simulation_adhesion(wanted)
    assert adhesion.work_of_adhesion.shape == (360, 720)
    assert adhesion.w_rms**2 == pytest.approx(4 * wanted.elastic_energy, rel=0.06)


@pytest.mark.parametrize("shape", sorted(SHAPES))
def test_uncorrelated_rows_have_the_second_order_of_the_spectrum(shape):
    schedule = LineSchedule(4.0, 480.0, 160.0, 3.0, 0.5, uncorrelated=True)
    wanted = of_shape(shape, schedule, tile_side=480.0, n_point=1440, n_angle=1440)
    adhesion = simulation_adhesion(wanted)
    fluctuation = adhesion.work_of_adhesion / WORK_OF_ADHESION
    # All modes across have the density of the sum along the front: of each row, times a pixel.
    power = np.abs(np.fft.rfft(fluctuation, axis=0)) ** 2 * adhesion.pixel / 480
    wavevector = 2 * np.pi * np.fft.rfftfreq(480, adhesion.pixel)
    density = adhesion.pixel * power.mean(axis=1)[1:]
    second = float(np.sum(wavevector[1:] * density)) * wavevector[1] / (2 * np.pi)
    assert second == pytest.approx(4 * wanted.elastic_energy, rel=0.05)
    assert abs(np.corrcoef(fluctuation[:, 0], fluctuation[:, 1])[0, 1]) < 0.5
    assert wanted.resolution.n_angle == wanted.resolution.n_point


def test_springs_are_multiples_of_the_length_that_is_named():
    for unit, length in (("correlation_length", correlation_length), ("larkin_length", None)):
        load = replace(SWEEP.schedule, spring_unit=unit)
        sweep = replace(SWEEP, schedule=load)
        simulation = sweep.simulation(SWEEP.spectra[1], 0.04, 0)
        kind, spectrum = simulation.kind, simulation.spectrum
        expected = length(kind, spectrum) if length else larkin_length(kind, spectrum, 0.4)
        assert simulation.schedule.spring == pytest.approx(8 * expected)
        assert simulation.schedule.length >= 9.999 * simulation.schedule.spring
        points, sides = simulation.tile
        assert sides[0] / points[0] == pytest.approx(sides[1] / points[1], rel=1e-12)


REFUSED = {
    "short front": ("length: 10,", "length: 9,", "load.line.length is 9; it must be greater"),
    "short tile": ("period: 20", "period: 19", "load.line.period is 19; it must be greater"),
    "no transient": ("transient: 6", "transient: 1", "load.line.transient is 1; it must be gre"),
    "no spring": ("springs: [2, 8]", "springs: [0]", "load.line.springs[0] is 0; it must be gre"),
    "negative": ("springs: [2, 8]", "springs: [-1]", "load.line.springs[0] is -1; it must be"),
    "twice": ("springs: [2, 8]", "springs: [2, 2]", "spring 2.0 stands twice"),
    "equal names": ("springs: [2, 8]", "springs: [2.0000001, 2]", "spring, 'flat-L2' stands twice"),
    "unit": ("step: 0.5", "step: 0.5, spring_unit: metre", "load.line.spring_unit is 'metre'"),
    "sphere too": ("load:", "load:\n  max_penetration: 1", "line already decides max_penetration"),
    "few states": (
        "step: 0.5",
        "step: 3",
        "the period of flat-L2 at e_el 0.04 has 2 states, and errors need 3 or more; lower step",
    ),
    "few sites": (
        "angles_per_cutoff: 2",
        "angles_per_cutoff: 0.75",
        "is 2.21, below two sites (2.67)",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_lines_are_refused_with_a_sentence(tmp_path, case):
    old, new, sentence = REFUSED[case]
    assert old in TEXT
    path = tmp_path / "line.yaml"
    path.write_text(TEXT.replace(old, new), encoding="utf-8")
    done = CliRunner().invoke(main, ["simulate", str(path), "--output", str(tmp_path)])
    assert done.exit_code == 2
    assert sentence in done.output


def test_a_schedule_without_extent_is_refused():
    with pytest.raises(ValueError, match=r"lead_in is 0\.0; it must be positive and finite"):
        replace(ONE.schedule, lead_in=0.0)
