"""How kernels are compiled, and that it is said when they are."""

import numpy as np
import pytest

from crackfront.core import compiled, kernel_cache


def quotient(a, b):
    return a / b


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """A cache folder of its own, not remembered afterwards."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    kernel_cache.kernel_folder.cache_clear()
    yield
    kernel_cache.kernel_folder.cache_clear()


@pytest.mark.usefixtures("fresh_cache")
def test_the_first_kernel_that_no_cache_holds_is_told_once():
    told = []
    compiled.when_compiling(lambda: None)
    compiled.when_compiling(lambda: told.append("compiling"))
    for counts in (["compiling"], ["compiling"]):
        assert compiled.jit(quotient)(1.0, 2.0) == 0.5
        assert compiled.jit(quotient)(1, 2) == 0.5
        assert told == counts
    told.clear()
    compiled.when_compiling(lambda: told.append("compiling"))
    assert compiled.jit(quotient)(1.0, 2.0) == 0.5
    assert told == []
    assert compiled.jit(quotient)(1.0, 2) == 0.5
    assert told == ["compiling"]


def test_a_compiled_division_by_zero_is_infinite():
    divide = compiled.jit(cache=False)(lambda a, b: a / b)
    assert divide(1.0, 0.0) == np.inf
    assert np.isnan(divide(0.0, 0.0))
