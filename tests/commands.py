"""Commands as tests run them, in their own process, and parameters that run at night."""

import functools

import pytest
from click.testing import CliRunner

from crackfront.cli import main

slow = functools.partial(pytest.param, marks=pytest.mark.slow)
"""Parameters whose test is left to the night."""


def run(*arguments):
    """Result of a command."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def refused(*arguments):
    """Sentence of a command that is refused."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    [sentence] = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    return sentence
