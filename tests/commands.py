"""Commands as tests run them, in their own process, and parameters that run at night."""

import functools

import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.data.packs import members
from crackfront.sweep.result_packs import pack_paths

slow = functools.partial(pytest.param, marks=pytest.mark.slow)
"""Parameters whose test is left to the night."""


def run(*arguments):
    """Result of a command."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def curves(folder):
    """Contents of the curves in the packs of a store, by their names."""
    found = [one for path in pack_paths(folder / "curves") for one in members(path)[0]]
    return {one.name: one.content() for one in found if one.name.endswith(".nc")}


def datasets(folder):
    """The same as datasets, without costs."""
    return {
        name: xr.load_dataset(content, engine="netcdf4").drop_vars(
            ["seconds", "cpu_seconds", "peak_memory"]
        )
        for name, content in sorted(curves(folder).items())
    }


def refused(*arguments):
    """Sentence of a command that is refused."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    [sentence] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    return sentence
