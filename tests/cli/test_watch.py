"""A cycle that is watched: its lines, on a terminal and in a log, and the same result."""

import io
import os
import pty
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.cli.watch import Progress, state_line
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import polar_field
from crackfront.core.units import WORK_OF_ADHESION


@pytest.fixture(scope="module")
def rays(tmp_path_factory):
    """File of samples on rays, and the arguments of a cycle over it."""
    path = tmp_path_factory.mktemp("rays") / "field.nc"
    radii, angle = 0.05 * np.arange(1, 61), 2 * np.pi * np.arange(8) / 8
    values = WORK_OF_ADHESION * (1 + 0.2 * np.sin(8 * radii)[:, None] * np.cos(2 * angle))
    xr.Dataset(
        {"work_of_adhesion": (("radius", "angle"), values)}, {"radius": radii, "angle": angle}
    ).to_netcdf(path)
    return ["cycle", "--field", str(path), "--max-penetration", "1", "--step", "0.25"]


@pytest.fixture(scope="module")
def circle():
    """Recorder of a smooth contact, past its largest load."""
    field = polar_field(0.05 * np.arange(1, 61), np.full((60, 8), WORK_OF_ADHESION))
    recorder = Recorder()
    run_cycle(field, LoadSchedule(1.0, 0.5), recorder=recorder)
    return recorder


def on_a_terminal(arguments):
    """What a command writes to a terminal."""
    controller, terminal = pty.openpty()
    command = [sys.executable, "-m", "crackfront", *arguments]
    process = subprocess.Popen(command, stderr=terminal, stdout=subprocess.DEVNULL)
    os.close(terminal)
    parts = []
    while True:
        try:
            part = os.read(controller, 65536)
        except OSError:  # Linux says so when the other end is closed
            break
        if not part:
            break
        parts.append(part)
    os.close(controller)
    assert process.wait(timeout=120) == 0
    return b"".join(parts).decode()


def test_the_line_of_a_state_tells_branch_load_force_radius_rms_and_sweeps(circle):
    last = circle.states[-1]
    assert state_line(circle.states) == (
        f"state {len(circle.states)}, retraction: penetration {last.penetration:+.4f}, "
        f"force {last.force:+.4f}, radius {last.mean_radius:.4f}, rms {last.rms_radius:.4f}, "
        f"{last.iterations} sweeps"
    )


def test_elsewhere_than_on_a_terminal_a_watched_cycle_prints_a_line_a_state(rays, tmp_path):
    result = CliRunner().invoke(main, [*rays, "--output", str(tmp_path / "out.nc"), "--watch"])
    assert result.exit_code == 0, result.output
    lines = result.stderr.splitlines()
    assert len(lines) == xr.load_dataset(tmp_path / "out.nc").sizes["step"]
    assert lines[0].startswith("state 1, approach: penetration +0.0000")
    assert "\x1b" not in result.output


def test_watching_a_cycle_does_not_change_it(rays, tmp_path):
    for name, more in (("plain", []), ("watched", ["--watch"])):
        assert (
            CliRunner().invoke(main, [*rays, "--output", str(tmp_path / name), *more]).exit_code
            == 0
        )
    plain, watched = (xr.load_dataset(tmp_path / name) for name in ("plain", "watched"))
    xr.testing.assert_equal(plain, watched)


class _Clock:
    """A clock that goes on by a second a state."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        """Seconds."""
        return self.now


def test_the_time_that_is_left_is_that_of_the_states_to_come(circle, monkeypatch):
    clock, terminal = _Clock(), io.StringIO()
    monkeypatch.setattr("crackfront.cli.watch.time", clock)
    monkeypatch.setattr(sys, "stderr", terminal)
    shown = Progress(expected=100)
    for count in range(1, 41):
        clock.now = 10.0 * count
        shown(SimpleNamespace(states=circle.states[:1] * count, front=circle.front))
    shown.finish()
    lines = terminal.getvalue().splitlines()
    # The first state begins the count; from then on there is a line every ten seconds.
    assert len(lines) == 39
    assert lines[0].startswith("state 2, approach: penetration")
    assert lines[0].endswith("; about 16.3 min left")
    assert lines[-1].startswith("state 40, ")
    assert lines[-1].endswith("; about 10 min left")


@pytest.mark.parametrize("more", [[], ["--watch"]])
def test_a_terminal_shows_one_line_that_replaces_itself(rays, tmp_path, more):
    text = on_a_terminal([*rays, "--output", str(tmp_path / "out.nc"), *more])
    *_, last, end = text.split("\r")
    found = xr.load_dataset(tmp_path / "out.nc")
    assert last.startswith(f"state {found.sizes['step']}, retraction: ")
    assert end == "\n"
