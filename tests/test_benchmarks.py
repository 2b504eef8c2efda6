"""The benchmarks run, and measure what they say."""

import json
import subprocess
import sys


def test_the_smoke_benchmark_reports_equal_fronts(tmp_path):
    command = [sys.executable, "-m", "benchmarks", "--group", "smoke", "--repeats", "1"]
    subprocess.run([*command, "--output", str(tmp_path)], check=True, timeout=280)
    (row,) = json.loads((tmp_path / "benchmark.json").read_text())
    assert row["status"] == "lost_contact"
    assert row["error"] < 1e-6
    assert row["newton_pairs"] < row["reference_pairs"]
    assert "| flat 0.16, w_rms 0.4, N 256" in (tmp_path / "benchmark.md").read_text()
