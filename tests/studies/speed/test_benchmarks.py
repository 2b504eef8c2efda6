"""The benchmarks run, and measure what they say."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crackfront.core.cycle.schedule import DEFAULT_STEP
from studies.accuracy import energy_balance
from studies.accuracy import predicted_energies as surfaces
from studies.speed import needs
from studies.speed.machine import peak_memory, restart_peak


def test_the_smoke_benchmark_reports_equal_fronts(tmp_path):
    command = [sys.executable, "-m", "studies.speed", "--group", "smoke", "--repeats", "1"]
    subprocess.run([*command, "--output", str(tmp_path)], check=True, timeout=280)
    with xr.open_dataset(tmp_path / "benchmark.nc") as table:
        (row,) = table.to_dataframe().to_dict("records")
    assert row["status"] == "lost_contact"
    assert row["error"] < 1e-6
    assert row["newton_pairs"] < row["reference_pairs"]
    assert row["memory"] > 50
    assert "| flat 0.16, w_rms 0.4, N 256" in (tmp_path / "benchmark.md").read_text()


@pytest.fixture(scope="module")
def requests():
    """What each request costs in a small scene, by its name."""
    return {need.name: needs.measure(needs.SMALL, need) for need in needs.NEEDS}


def test_asking_for_less_holds_and_stores_less(requests):
    for less, more in (
        ("hysteresis", "cycle"),
        ("cycle", "cycle, energies"),
        ("cycle, energies", "cycle, fronts"),
        ("cycle, fronts", "cycle, fronts, energies"),
    ):
        assert requests[less].record < requests[more].record, more
        assert requests[less].file < requests[more].file, more
    assert requests["rings"].record == requests["rings as a front"].record
    assert requests["rings"].field < requests["rings as a front"].field / 100
    assert requests["rings"].field + requests["rings"].record < requests["cycle"].field


def test_fronts_are_the_only_large_part_of_a_record(requests):
    full = requests["cycle, fronts"]
    fronts = 8e-6 * full.n_step * full.n_angle
    assert full.record - requests["cycle"].record == pytest.approx(fronts, rel=1e-12)
    assert fronts > 5 * requests["cycle, energies"].record


def test_the_hysteresis_alone_crosses_less_of_the_field_in_fewer_steps(requests):
    alone, cycle, rings = (requests[name] for name in ("hysteresis", "cycle", "rings"))
    assert (alone.status, cycle.status, rings.status) == ("steady", "lost_contact", "lost_contact")
    assert alone.n_step < cycle.n_step
    assert alone.samples < 0.7 * cycle.samples
    # Out from the centre and back: two radii of about 1.8 at 16 samples a period of 0.2.
    assert rings.samples == pytest.approx(2 * 1.8 / 0.2 * 16, rel=0.1)


def test_the_page_of_requests_lists_them_all(requests):
    rows = list(requests.values())
    page = needs.report(rows)
    assert all(f"| {need.name} |" in page and need.asked in page for need in needs.NEEDS)
    assert np.array_equal(needs.dataset(rows)["file"], [row.file for row in rows])


@pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="the mark is Linux's")
def test_the_peak_of_memory_starts_anew_and_sees_an_array_that_is_gone():
    before = restart_peak()
    np.ones(5_000_000)
    assert 35 < peak_memory() - before < 60
    assert restart_peak() - before < 10


def test_the_table_of_energies_shows_round_off_for_the_work_and_the_first_order_for_the_rest():
    steps = (0.1, 0.05, 0.025)
    found = [energy_balance.energies(energy_balance.cycle(0.4, 0, step)) for step in steps]
    lost, work, trapezoid = np.transpose(found)
    assert np.allclose(lost, work, rtol=1e-13)
    assert np.all(np.diff(lost) < 0)
    gap = lost - trapezoid
    assert np.allclose(gap[:-1] / gap[1:], 2, atol=0.15)
    assert gap[1] > 0.05 * work[1]


@pytest.mark.parametrize("rms", [0.1, 0.4, 0.84])
def test_the_default_step_leaves_one_percent_of_the_energy_of_the_quasi_static_loop(rms):
    fine, default = (
        energy_balance.energies(energy_balance.cycle(rms, 0, step))[0]
        for step in (DEFAULT_STEP / 2, DEFAULT_STEP)
    )
    assert 0 < default / (2 * fine - default) - 1 < 0.01


@pytest.mark.slow
def test_ten_large_maps_take_less_than_15_s_of_one_core():
    found = list(surfaces.speeds())
    assert [one.what for one in found] == ["without figure", "with figure"]
    for one in found:
        assert one.together < min(15, one.single)
