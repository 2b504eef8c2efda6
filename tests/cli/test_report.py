"""What commands share."""

import io
import sys
import time

import pytest
import tqdm

from crackfront.sweep.watching import with_progress


class Terminal(io.StringIO):
    """Standard error that is a terminal."""

    def isatty(self):
        return True


@pytest.fixture
def pace(monkeypatch):
    """Start a clock that each thing of an iterable advances by some seconds."""
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    monkeypatch.setattr(tqdm.std, "time", lambda: now[0])

    def paced(number, seconds):
        for step in range(number):
            now[0] += seconds
            yield step

    return paced


def test_a_log_has_lines_at_doubling_times(pace, capsys):
    assert [*with_progress(pace(40, 2.0), 40, "shards")] == [*range(40)]
    assert capsys.readouterr().err.splitlines() == [
        f"{number} of 40 shards" for number in (3, 7, 15, 31)
    ]


@pytest.mark.parametrize("seconds", [0.1, 2.0])
def test_a_terminal_shows_a_bar_of_what_takes_more_than_a_few_seconds(pace, monkeypatch, seconds):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert [*with_progress(pace(10, seconds), 10, "shards")] == [*range(10)]
    assert ("shards" in terminal.getvalue()) == (seconds > 1)
