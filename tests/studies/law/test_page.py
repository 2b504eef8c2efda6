"""The pages hold the numbers of the law of k."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.analysis.finding import crossing, stated_breadths
from crackfront.analysis.law import law_value, pinning_factor, shipped_law
from studies.__main__ import main
from studies.law.commands import PAGES
from studies.law.page import limit_part

ROOT = Path(__file__).parents[3]


def test_the_pages_hold_the_numbers_of_the_law(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    for name in PAGES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(Path(name).read_text())
    done = CliRunner().invoke(main, ["law", "pages", "--output", str(tmp_path)])
    assert done.exit_code == 0, done.output
    for name in PAGES:
        # Otherwise: python -m studies law pages
        assert (tmp_path / name).read_text() == Path(name).read_text()
        assert "<!-- law: " in Path(name).read_text()


def test_the_table_of_the_limit_holds_its_values_and_where_k_is_that_of_the_paper():
    text = limit_part()
    for breadth in stated_breadths().values():
        k = pinning_factor(0.4, np.inf, breadth=breadth).factor
        assert f"| {k.value:.2f} ({k.low:.2f} to {k.high:.2f}) |" in text
    s, low, high = crossing()
    assert float(law_value(shipped_law().coefficients, s, np.inf)) == pytest.approx(3)
    assert pinning_factor(low, np.inf).factor.low == pytest.approx(3)
    assert pinning_factor(high, np.inf).factor.high == pytest.approx(3)
