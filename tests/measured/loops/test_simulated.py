"""Simulated cycles as loops: the works of adhesion of the simulation, from files in all units."""

import functools
import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

import crackfront as cf
from crackfront import measured_loop
from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.cli import main
from crackfront.measured.loops.loop_page import loop_numbers
from crackfront.simulate.cycle_files import cycle_record

SPHERE = cf.Scales("1.25mm", "63mJ/m2", "0.93MPa")
WORKS = ("w_appr", "w_retr", "hysteresis")
FLAT = {"short_cutoff": 0.1, "side": 4.0}
SPECTRA = {"flat": FLAT, "self-affine": FLAT | {"roll_off": 0.4, "hurst": 0.8}}


def run(spectrum, **options):
    """A cycle on a surface of a spectrum, by its name."""
    surface = cf.random_surface(elastic_energy=0.03, seed=3, **SPECTRA[spectrum])
    return cf.run_loop(surface, step=0.03, **options)


whole_cycle = functools.cache(run)
"""A cycle until contact is lost, run once for each spectrum."""


@pytest.fixture(params=SPECTRA)
def cycle(request):
    return whole_cycle(request.param)


@pytest.fixture
def path(tmp_path):
    """File of a cycle in reduced units."""
    path = tmp_path / "cycle.nc"
    cf.save_result(whole_cycle("flat"), path)
    return path


def loop(*arguments):
    return CliRunner().invoke(main, ["loop", *map(str, arguments)])


def test_a_cycle_has_the_works_of_adhesion_of_its_simulation(cycle):
    result = measured_loop(cycle)
    expected = steady_adhesion(cycle_record(cycle), float(cycle.correlation_length))
    for name in WORKS:
        estimate = getattr(result, name)
        assert estimate.value == pytest.approx(getattr(expected, name), rel=1e-12)
        assert estimate.standard_error == pytest.approx(getattr(expected, f"{name}_error"))
        assert estimate.low < estimate.value < estimate.high
    averaged = result.in_window & (result.direction < 0)
    assert np.mean(result.work_of_adhesion[averaged]) == pytest.approx(expected.w_retr, rel=1e-12)
    assert result.window == pytest.approx((expected.lowest_radius, expected.highest_radius))


def test_a_file_in_si_units_has_them_times_w_int(cycle, tmp_path):
    reduced, path = measured_loop(cycle), tmp_path / "cycle.nc"
    cf.save_result(cf.in_si_units(cycle, SPHERE), path)
    result = measured_loop(path)
    for name in WORKS:
        work = SPHERE.work_of_adhesion * getattr(reduced, name).value
        assert getattr(result, name).value == pytest.approx(work, rel=1e-12)
    assert result.lost_energy == pytest.approx(SPHERE.work_of_adhesion * reduced.lost_energy)
    assert result.pull_off_force.value == pytest.approx(-SPHERE.force * float(cycle.force.min()))
    assert (result.sphere_radius, result.contact_modulus.value) == (1.25e-3, 0.93e6)
    assert result.window == pytest.approx(np.array(reduced.window) * SPHERE.lateral)


def test_the_energy_lost_is_that_of_all_instabilities():
    """To what a coarse load step adds to them."""
    cycle = run("flat", energy=True)
    energy = float(cycle.dissipated_energy.sum()) + cycle.attrs["pull_off_energy"]
    area = np.pi * float(cycle.mean_radius.max()) ** 2
    assert measured_loop(cycle).lost_energy == pytest.approx(np.pi * energy / area, rel=0.1)


def test_the_command_prints_reduced_units_and_those_of_a_sphere_that_is_named(path):
    w_retr = float(cf.load_result(path).w_retr)
    done = loop(path, "--json")
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    assert content["units"] == "reduced"
    assert content["w_retr"]["value"] == pytest.approx(w_retr, rel=1e-12)
    assert loop(path).stdout.splitlines()[2].split()[:3] == ["w_retr", f"{w_retr:.4g}", "w_int"]
    sphere = ("--radius", "1.25mm", "--modulus", "0.7MPa", "--poisson", "0.5")
    sphere += ("--work-of-adhesion", "63mJ/m2")
    done = loop(path, *sphere, "--figure", path.with_name("loop.png"), "--json")
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    assert content["units"] == "SI"
    assert content["w_retr"]["value"] == pytest.approx(63e-3 * w_retr, rel=1e-12)
    assert path.with_name("loop.png").stat().st_size > 1e4


def test_reduced_units_have_an_interval_where_it_has_a_width():
    texts = dict(loop_numbers(measured_loop(whole_cycle("flat"))))
    assert " to " in texts["w_retr"]
    assert re.fullmatch(r"\S+ pi w_int R", texts["pull-off force"])


def test_cycles_without_works_of_adhesion_are_refused_with_what_to_do(cycle):
    with pytest.raises(ValueError, match="states neither a correlation length nor the spectrum"):
        measured_loop(cycle.drop_vars("correlation_length"))
    with pytest.raises(ValueError, match=r"lacks works of adhesion: .*penetrate deeper"):
        measured_loop(cycle.isel(step=slice(0, 8)))
    surface = cf.random_surface(elastic_energy=0.03, seed=3, **FLAT)
    straight = cf.run_loop(cf.straight_front(surface, spring=2.0), loads=[0, 2, 0], step=0.5)
    with pytest.raises(ValueError, match="straight front"):
        measured_loop(straight)
