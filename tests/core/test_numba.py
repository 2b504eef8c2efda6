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
    "numba.core.caching:NullCache.load_overload": ["self", "sig", "target_context"],
    "numba.core.caching:NullCache.save_overload": ["self", "sig", "cres"],
    "numba.core.compiler:CompileResult._reduce": ["self"],
    "numba.core.compiler:CompileResult._rebuild": [
        *("target_context", "libdata", "fndesc", "env", "signature", "objectmode", "lifted"),
        *("typeann", "reload_init", "referenced_envs"),
    ],
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
        f"{what} of {versions} is not what core/kernel_cache.py, core/compiled.py and "
        "core/solver/filters.py use; adapt them, then the bound in pyproject.toml"
    )


@pytest.mark.parametrize("place", PRIVATE)
def test_a_private_function_takes_what_it_is_given(place):
    try:
        found = list(inspect.signature(pkgutil.resolve_name(place)).parameters)
    except (ImportError, AttributeError):
        found = None
    assert found == PRIVATE[place], moved(place)


def test_a_dispatcher_asks_the_cache_that_it_is_given():
    import numba

    asked = []

    class Cache(numba.core.caching.NullCache):
        def load_overload(self, sig, target_context):
            asked.append(("load", sig, target_context.codegen().magic_tuple()))

        def save_overload(self, sig, data):
            asked.append(("save", sig, data.codegen.magic_tuple()))
            assert data.library.has_dynamic_globals is False, moved("CompileResult.library")

    doubled = numba.njit(lambda a: 2 * a, error_model="numpy", _nrt=False)
    doubled._cache = Cache()
    assert doubled(1.5) == 3
    assert [one[0] for one in asked] == ["load", "save"], moved("Dispatcher._cache")
    assert asked[0][1:] == asked[1][1:] == ((numba.float64,), asked[0][2]), moved("Dispatcher")
    assert issubclass(numba.types.NamedTuple, numba.types.BaseNamedTuple), moved("NamedTuple")


@pytest.mark.parametrize("name", ["numba", "rocket-fft"])
def test_a_library_whose_private_functions_are_used_is_bounded_above(name):
    [stated] = [one for text in DEPENDENCIES if (one := Requirement(text)).name == name]
    assert any(part.operator == "<" for part in stated.specifier), f"{stated} has no upper bound"
    assert stated.specifier.contains(version(name))
