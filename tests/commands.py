"""Commands as tests run them, in their own process, and what they stored."""

import contextlib
import functools
import re

import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.sweep.curves import curve_files
from crackfront.sweep.rows import row_columns
from crackfront.sweep.table_file import columns_dataset

slow = functools.partial(pytest.param, marks=pytest.mark.slow)
"""Parameters whose test is left to the night."""

COSTS = ("seconds", "cpu_seconds", "peak_memory")
"""Variables in which equal simulations differ."""


def run(*arguments):
    """Result of a command."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def done(*arguments):
    """Result of a command that succeeds."""
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return result


def refused(*arguments):
    """Sentence of a command that is refused."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    [sentence] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    return sentence


def simulated(output):
    """Labels of the simulations that a command ran, by what it printed."""
    return set(re.findall(r"^\[\d+/\d+\] (.+?): ", output, re.MULTILINE))


def curve_paths(folder):
    """Files of finished simulations of a sweep."""
    return [path for shard in sorted((folder / "curves").glob("*")) for path in curve_files(shard)]


def stored(folder):
    """Wall times of the stored simulations, which say that it was the same run.

    Names are made of spectrum, e_el, realisation and series.
    """
    times = {}
    for path in curve_paths(folder):
        with contextlib.suppress(FileNotFoundError), xr.open_dataset(path) as dataset:
            names = ("spectrum", "elastic_energy", "realisation", "series", "seconds")
            for *identity, seconds in zip(*(dataset[name].values for name in names), strict=True):
                times["{}-e{:g}-r{}-{}".format(*identity)] = seconds
    return times


def table(path):
    """A table or shard without its costs; `equals` compares two of any origin."""
    return xr.load_dataset(path).drop_vars(COSTS)


def dataset_of_rows(sweep, rows):
    """Dataset of the rows of all simulations of a sweep, in their order."""
    shape = len(sweep.spectra), len(sweep.elastic_energies), sweep.n_realisation
    return columns_dataset(sweep, row_columns(rows, shape), range(sweep.n_realisation))
