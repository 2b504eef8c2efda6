"""Private functions of numba and rocket-fft that kernels rest on: there, and as they are used."""

import inspect
import pkgutil
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.requirements import Requirement

DEPENDENCIES = tomllib.loads(Path(__file__).parents[2].joinpath("pyproject.toml").read_text())[
    "project"
]["dependencies"]

PRIVATE = {
    "numba.core.caching:FunctionCache.load_overload": ["self", "sig", "target_context"],
    "numba.core.caching:FunctionCache.save_overload": ["self", "sig", "data"],
    "numba.core.caching:CompileResultCacheImpl.reduce": ["self", "cres"],
    "numba.core.caching:CompileResultCacheImpl.rebuild": ["self", "target_context", "payload"],
    "numba.core.serialize:dumps": ["obj"],
    "numba.core.event:register": ["kind", "listener"],
    "numba.core.event:Listener.on_start": ["self", "event"],
    "numba.core.event:Listener.on_end": ["self", "event"],
    "rocket_fft.lowlevel:c2c": ["typingctx", "ain", "aout", "axes", "forward", "fct", "nthreads"],
}
"""Arguments of what is used, by its place."""


def moved(what):
    """What to do where a library no longer has what is used of it."""
    versions = f"numba {version('numba')} or rocket-fft {version('rocket-fft')}"
    return (
        f"{what} of {versions} is not what core/compiled.py and "
        "core/solver/filters.py use; adapt them, then the bound in pyproject.toml"
    )


@pytest.mark.parametrize("place", PRIVATE)
def test_a_private_function_takes_what_it_is_given(place):
    try:
        found = list(inspect.signature(pkgutil.resolve_name(place)).parameters)
    except (ImportError, AttributeError):
        found = None
    assert found == PRIVATE[place], moved(place)


@pytest.mark.parametrize("name", ["numba", "rocket-fft"])
def test_a_library_whose_private_functions_are_used_is_bounded_above(name):
    [stated] = [one for text in DEPENDENCIES if (one := Requirement(text)).name == name]
    assert any(part.operator == "<" for part in stated.specifier), f"{stated} has no upper bound"
    assert stated.specifier.contains(version(name))
