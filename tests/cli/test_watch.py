"""A cycle that is watched: dots, frames, lines, and the same result."""

import fcntl
import io
import os
import pty
import re
import struct
import subprocess
import sys
import termios
from types import SimpleNamespace

import click
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.cli.watch import Canvas, Progress, Watch, duration, frame, state_line
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


def on_a_terminal(arguments, columns):
    """What a command writes to a terminal of so many columns."""
    controller, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
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


def test_the_dots_of_a_canvas_are_where_the_points_are():
    canvas = Canvas(2, 1, 0.0, 3.0, 0.0, 3.0)
    canvas.add(np.array([0.0, 3.0, 9.0]), np.array([3.0, 0.0, 1.0]), "red")
    assert click.unstyle(canvas.lines()[0]) == "\u2801\u2880"


def test_a_character_has_the_colour_of_its_last_dot():
    canvas = Canvas(1, 1, 0.0, 1.0, 0.0, 3.0)
    for x, colour in ((0.0, "red"), (1.0, "blue")):
        canvas.add(np.array([x]), np.array([0.0]), colour)
    assert canvas.lines() == [click.style("\u28c0", fg="blue")]


@pytest.mark.parametrize("columns", [60, 79, 140])
def test_a_frame_fits_the_terminal_and_the_front_is_round(circle, columns):
    lines = [
        click.unstyle(line)
        for line in frame(circle.states, circle.front, columns, 2.0, (-2.0, 1.0))
    ]
    assert all(len(line) <= columns for line in lines)
    plane = [line.split("│")[0] for line in lines[:-1]]
    dots = [
        (2 * column + right, 4 * row + down)
        for row, line in enumerate(plane)
        for column, character in enumerate(line)
        if character != " "
        for down, bits in enumerate(((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80)))
        for right, bit in enumerate(bits)
        if (ord(character) - 0x2800) & bit
    ]
    x, y = np.array(dots).T - np.array([[71 / 2], [71 / 2]])
    # 71 steps between dots stand for the four reduced lengths that are shown.
    assert np.hypot(x, y) * 4 / 71 == pytest.approx(circle.front[0], abs=0.06)


def test_the_line_of_a_state_tells_branch_load_radius_and_force(circle):
    last = circle.states[-1]
    assert state_line(circle.states) == (
        f"state {len(circle.states)}, retraction: penetration {last.penetration:+.4f}, "
        f"radius {last.mean_radius:.4f}, force {last.force:+.4f}"
    )


def test_elsewhere_than_on_a_terminal_a_watched_cycle_prints_a_line_a_state(rays, tmp_path):
    result = CliRunner().invoke(main, [*rays, "--output", str(tmp_path / "out.nc"), "--watch"])
    assert result.exit_code == 0, result.output
    lines = result.stderr.splitlines()
    assert len(lines) == xr.load_dataset(tmp_path / "out.nc").sizes["step"]
    assert lines[0].startswith("state 1, approach: penetration +0.0000")
    assert "\x1b" not in result.output


def test_on_a_terminal_frames_replace_each_other_and_the_last_state_stays(rays, tmp_path):
    text = on_a_terminal([*rays, "--output", str(tmp_path / "out.nc"), "--watch"], columns=100)
    *_, last = re.split(r"\x1b\[\d+A\x1b\[J", text)
    assert set(re.findall(r"\x1b\[(\d+)A", text)) == {"20"}
    lines = click.unstyle(last).split("\r\n")
    assert len(lines) == 21
    found = xr.load_dataset(tmp_path / "out.nc")
    assert lines[0].startswith(f"state {found.sizes['step']}, retraction")


@pytest.mark.parametrize(("size", "height"), [((100, 40), 20), ((40, 40), 1), ((100, 12), 1)])
def test_a_terminal_without_room_for_the_panels_shows_the_line_alone(
    circle, monkeypatch, size, height
):
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr(terminal, "fileno", lambda: 2)
    monkeypatch.setattr(os, "get_terminal_size", lambda _: os.terminal_size(size))
    monkeypatch.setattr(sys, "stderr", terminal)
    shown = Watch(1, 1.0)
    shown(circle)
    shown.finish()
    first, second = terminal.getvalue().split(f"\x1b[{height}A\x1b[J")
    assert first == second
    assert first.startswith(state_line(circle.states))
    assert len(first.splitlines()) == height


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
    assert lines[0].endswith("; about 16 min left")
    assert lines[-1].startswith("state 40, ")
    assert lines[-1].endswith("; about 10 min left")


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.2, "1 s"), (12.34, "12 s"), (89.9, "90 s"), (5000, "83 min"), (9e4, "25 h")],
)
def test_a_time_is_told_in_the_unit_that_a_person_would_take(seconds, text):
    assert duration(seconds) == text


def test_without_watch_a_terminal_shows_one_line_that_replaces_itself(rays, tmp_path):
    text = on_a_terminal([*rays, "--output", str(tmp_path / "out.nc")], columns=100)
    *_, last, end = text.split("\r")
    found = xr.load_dataset(tmp_path / "out.nc")
    assert last.startswith(f"state {found.sizes['step']}, retraction: ")
    assert end == "\n"
