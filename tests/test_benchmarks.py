"""The benchmarks run, and measure what they say."""

import subprocess
import sys

import numpy as np
import xarray as xr

from benchmarks import hysteresis
from benchmarks.hysteresis import Case, Setting
from crackfront.spectrum import SelfAffineSpectrum


def test_the_smoke_benchmark_reports_equal_fronts(tmp_path):
    command = [sys.executable, "-m", "benchmarks", "--group", "smoke", "--repeats", "1"]
    subprocess.run([*command, "--output", str(tmp_path)], check=True, timeout=280)
    with xr.open_dataset(tmp_path / "benchmark.nc") as table:
        (row,) = table.to_dataframe().to_dict("records")
    assert row["status"] == "lost_contact"
    assert row["error"] < 1e-6
    assert row["newton_pairs"] < row["reference_pairs"]
    assert row["memory"] > 50
    assert "| flat 0.16, w_rms 0.4, N 256" in (tmp_path / "benchmark.md").read_text()


def test_the_error_of_the_hysteresis_falls_with_finer_numerics():
    case = Case("small", 0.4, SelfAffineSpectrum(0.2, 0.2, 1.0), 20, 0.1, authors_seconds=50.0)
    settings = [Setting(n, 4, "cubic", 4, 1e-4) for n in (1.4, 2.8)]
    rows, finest = hysteresis.study(case, {"sites of the front": settings})
    assert rows[1].rms < rows[0].rms / 2 < 0.5
    assert rows[1].rms >= abs(rows[1].bias)
    assert 0 < rows[1].seconds < finest.seconds
    table = hysteresis.table(case, rows, finest)
    assert f"| {50 / rows[1].seconds:.0f} times |" in table
    stored = hysteresis.dataset({"small": rows})
    assert np.array_equal(stored["rms"], [row.rms for row in rows])
    assert len(hysteresis.work_precision(case, rows).legends) == 1


def test_pixels_do_not_change_the_surface_of_a_case():
    case = hysteresis.CASES[2]
    coarse, fine = (hysteresis.surface(case, pixels, 3).work_of_adhesion for pixels in (4, 8))
    assert np.allclose(fine[::2, ::2], coarse, rtol=0, atol=1e-12)
