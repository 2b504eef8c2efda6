"""Scans that tests make and read."""

import functools
from pathlib import Path

import numpy as np
import pytest

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import Scales
from crackfront.measured.options import reading_options
from crackfront.measured.scan.reading import Measurement, read_measurements
from crackfront.measured.spectrum import draws
from crackfront.measured.spectrum.measured_surface import read_surface
from crackfront.simulate.run_simulation import run_simulation
from studies.accuracy import scans

FOLDER = Path(__file__).parents[2] / "examples/scans"
DETAIL, OVERVIEW = FOLDER / "nanodiamond-detail.al3d", FOLDER / "nanodiamond-overview.al3d"
SCENE = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)

SIDE = 20e-6
SPECTRUM = SelfAffineSpectrum(0.4e-6, 3e-6, hurst=0.8, plateau=1e-26)
HEAD = "# Channel: Main\n# Width: 20 um\n# Height: 20 um\n# Value units: um\n"


def map_heights(rng, n_point=128, spectrum=SPECTRUM, side=SIDE):
    """Heights of a map whose edges do not fit together."""
    return gaussian_field(spectrum, 2 * n_point, 2 * side, rng)[:n_point, :n_point]


def write_al3d(path, heights, side=SIDE, comment="test"):
    """An AL3D file of a map."""
    path.write_bytes(scans.al3d(heights, side / len(heights), comment))
    return path


def write_text(path, heights, cell=lambda row, column, text: text):
    """A map as text, in um."""
    rows = (
        " ".join(cell(i, j, f"{value:.6f}") for j, value in enumerate(row))
        for i, row in enumerate(1e6 * heights.T)
    )
    path.write_text(HEAD + "\n".join(rows) + "\n")
    return path


def one_cell(text):
    """What replaces a cell in the middle by a text."""
    return lambda row, column, cell: text if (row, column) == (20, 7) else cell


def write_line(path, heights, pixel):
    """A text file of a line, in two columns without units."""
    np.savetxt(path, np.column_stack([pixel * np.arange(heights.size), heights]))
    return path


def read(path, **options):
    """Measurement of a file, read by options as a user gives them."""
    return read_measurements([path], reading_options(options, 1))[0]


def measured_once(paths, options):
    """Surface of files that stay as they are, measured once by equal options and as many draws."""
    return _measured(tuple(paths), tuple(options), draws.BATCH)


@functools.cache
def _measured(paths, options, n_draw):
    return read_surface(paths, options)


def shipped_surface(*paths, **options):
    """Surface of scans that are shipped, read by options as a user gives them."""
    return measured_once(paths, reading_options(options, len(paths)))


def draw_little(monkeypatch):
    """One small batch of draws, which is taken as sufficient."""
    monkeypatch.setattr(draws, "BATCHES", (1,))
    monkeypatch.setattr(draws, "BATCH", 2**12)
    monkeypatch.setattr("crackfront.measured.prediction.surface_remarks._MOST_UNSETTLED", 1.0)


def measure_surfaces_once(monkeypatch):
    """Let commands and library measure equal files once for each of their options."""
    for module in ("predict", "samples.sample_results", "spectrum.measured_surface"):
        monkeypatch.setattr(f"crackfront.measured.{module}.read_surface", measured_once)


simulated_once = functools.cache(run_simulation)
"""Result of a simulation, of which equal ones are run once."""


def run_simulations_once(monkeypatch):
    """Let predictions run equal simulations once."""
    place = "crackfront.measured.prediction.simulated_prediction.run_simulation"
    monkeypatch.setattr(place, simulated_once)


def refusal(*paths, **options):
    """Sentence for files that are refused."""
    with pytest.raises(ValueError, match=r".") as caught:
        read_surface(paths, reading_options(options, len(paths)))
    message = str(caught.value)
    assert "\n" not in message
    return message


def write_smooth(path):
    """Scan of a surface with a third of the heights of nanodiamond, showing all that matters."""
    spectrum = SelfAffineSpectrum(0.2e-6, 2.1e-6, 0.95, 1e-27)
    heights = gaussian_field(spectrum, 256, 25.6e-6, np.random.default_rng(3))
    return write_al3d(path, heights, 25.6e-6, "smooth")


def measured_mean_square(scan, order):
    """Mean square of a derivative of a scan over its trusted wavelengths, as it stands."""
    waves, (low, high) = scan.waves, (2 * np.pi / length for length in scan.band.wavelengths[::-1])
    inside = (waves.wavevector >= low) & (waves.wavevector <= high)
    power = waves.count[inside] * waves.power[inside]
    steps = np.prod([step / (2 * np.pi) for step in waves.steps])
    return float(np.sum(power * waves.wavevector[inside] ** (2 * order)) * steps)


def periodic_measurement(heights, side=SIDE, shortest=None):
    """A map that is one period of its surface, all waves trusted down to two pixels."""
    pixel = side / len(heights)
    shortest = 2 * pixel if shortest is None else shortest
    return Measurement(
        Path("periodic"), "", "", "", (side, side), heights, True, shortest, side * (1 + 1e-9)
    )
