"""How kernels are compiled and kept, what happens to damaged files, and when it is said."""

import errno
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from crackfront.core import cache_folder, compiled


def quotient(a, b):
    return a / b


@pytest.fixture(autouse=True)
def _nothing_said():
    compiled._say_damaged.cache_clear()


def cache_hits():
    """Versions of a new kernel that were found on disk, once it has given the right answer."""
    kernel = compiled.jit(quotient)
    assert kernel(1.0, 4.0) == 0.25
    return sum(kernel.stats.cache_hits.values())


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
    divide = compiled.jit(quotient)
    assert divide(1.0, 0.0) == np.inf
    assert np.isnan(divide(0.0, 0.0))


@pytest.fixture
def package(tmp_path):
    """A package of two kernels, in two files, one of which calls the other."""
    core = tmp_path / "sources/crackfront/core"
    core.mkdir(parents=True)
    for folder in (core, core.parent):
        (folder / "__init__.py").touch()
    for module in (compiled, cache_folder):
        shutil.copy(module.__file__, core)
    (core / "inner.py").write_text(
        "from crackfront.core.compiled import jit\n\n\n@jit\ndef inner(a):\n    return a + 1\n"
    )
    (core / "outer.py").write_text(
        "from crackfront.core.compiled import jit\nfrom crackfront.core.inner import inner\n\n\n"
        "@jit\ndef outer(a):\n    return 10 * inner(a)\n"
    )
    return tmp_path / "sources"


ASKED = """
import numba
from crackfront.core.compiled import when_compiling
from crackfront.core.outer import outer
compiling = []
when_compiling(lambda: compiling.append(True))
print(outer(2), bool(compiling), repr(numba.config.CACHE_DIR))
"""


def started(package, code=ASKED, **environment):
    """A process that calls the kernels of the package."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    kept |= {"XDG_CACHE_HOME": str(package.with_name("cache")), **environment}
    return subprocess.Popen(
        [sys.executable, "-c", code],
        cwd=package,
        env=kept,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def answer(process):
    """What the process wrote to standard output and to standard error."""
    printed, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    return printed.strip(), errors


@pytest.mark.slow
def test_a_second_process_compiles_nothing_unless_a_callee_in_another_file_changes(package):
    assert answer(started(package)) == ("30 True ''", "")
    assert answer(started(package)) == ("30 False ''", "")
    callee = package / "crackfront/core/inner.py"
    callee.write_text(callee.read_text().replace("a + 1", "a + 2"))
    assert answer(started(package)) == ("40 True ''", "")


@pytest.mark.slow
def test_processes_that_compile_at_once_agree_and_leave_a_whole_cache(package):
    together = [started(package) for _ in range(3)]
    assert {answer(process)[0].split()[0] for process in together} == {"30"}
    assert answer(started(package)) == ("30 False ''", "")


@pytest.mark.slow
@pytest.mark.parametrize("place", ["nowhere", "unwritable"])
def test_without_a_usable_folder_nothing_is_kept_not_even_next_to_the_sources(package, place):
    if place == "unwritable":
        # numba then turns to other folders on its own.
        answer(started(package))
        for folder in package.with_name("cache").glob("crackfront/kernels-*/*"):
            shutil.rmtree(folder)
            folder.write_text("not a folder")
    else:
        package.with_name("cache").write_text("not a folder")
    code = f"import tempfile; tempfile.tempdir = {__file__!r}\n{ASKED}"
    for _ in range(2):
        printed, errors = answer(started(package, code))
        assert printed == "30 True ''"
        assert errors.count("\n") == ("XDG_CACHE_HOME" in errors) == (place == "nowhere")
    assert [path for path in package.parent.rglob("*.nb?") if path.is_file()] == []


def truncated(content):
    return content[: len(content) // 2]


def flipped(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


@pytest.mark.parametrize(("suffix", "harm"), [("nbi", truncated), ("nbc", flipped)])
def test_a_damaged_kernel_is_compiled_again_and_one_line_says_so(fresh_cache, caplog, suffix, harm):
    assert (cache_hits(), cache_hits()) == (0, 1)
    assert caplog.messages == []
    [path] = fresh_cache.rglob(f"*.{suffix}")
    for _ in range(2):
        path.write_bytes(harm(path.read_bytes()))
        assert (cache_hits(), cache_hits()) == (0, 1)
    folder = cache_folder.kernel_folder()
    assert caplog.messages == [f"compiled kernels in {folder} are damaged; they are compiled again"]


def test_a_file_of_another_signature_is_not_executed(fresh_cache):
    def answers():
        kernel = compiled.jit(quotient)
        assert (kernel(1.0, 4.0), kernel(1, 4)) == (0.25, 0.25)
        return sum(kernel.stats.cache_hits.values())

    assert (answers(), answers()) == (0, 2)
    first, second = sorted(fresh_cache.rglob("*.nbc"))
    content = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(content)
    assert answers() < 2
    assert answers() == 2


@pytest.mark.usefixtures("fresh_cache")
def test_a_full_disk_costs_the_cache_and_no_result(monkeypatch):
    def full(self, *_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._save_data", full)
    assert (cache_hits(), cache_hits()) == (0, 0)
