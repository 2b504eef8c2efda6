"""Both solvers on the same problems: their fronts are equal, and the table says what they took."""

import pytest
import xarray as xr
from click.testing import CliRunner

from studies.__main__ import main


@pytest.mark.slow
def test_the_smoke_benchmark_reports_equal_fronts(tmp_path):
    command = ["speed", "solvers", "--group", "smoke", "--repeats", "1", "--output", str(tmp_path)]
    done = CliRunner().invoke(main, command)
    assert done.exit_code == 0, done.output
    with xr.open_dataset(tmp_path / "solvers.nc") as table:
        (row,) = table.to_dataframe().to_dict("records")
    assert row["status"] == "lost_contact"
    assert row["error"] < 1e-6
    assert row["newton_pairs"] < row["reference_pairs"]
    assert row["memory"] > 50
    page = (tmp_path / "solvers.md").read_text()
    assert "Machine: " in page.split("| flat 0.16, w_rms 0.4, N 256")[0]
