"""The core stands alone: it needs numpy, scipy and numba, and leaves its importer as it was."""

import inspect
import subprocess
import sys

import numpy as np
import pytest

from crackfront import core

BLOCKED = (
    "xarray netCDF4 mpi4py snakemake matplotlib pandas click ruamel pint tqdm finufft PIL "
    "SurfaceTopography"
)

ALONE = f"""
import importlib.abc, sys

class Blocked(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in {BLOCKED.split()}:
            raise ModuleNotFoundError(f"{{name}} is blocked")

sys.meta_path.insert(0, Blocked())
"""

OTHERS = """
others = [name for name in sys.modules if name.startswith("crackfront.")
          and not name.startswith("crackfront.core")]
assert not others, others
"""


def cycle():
    """How a small cycle ends, and the digits of its radii."""
    noise = np.random.default_rng(1).standard_normal((16, 16)) / 5
    field = core.contact_field(core.chemical_adhesion(noise, 0.2), 0.5, n_site=24)
    record = core.run_cycle(field, core.LoadSchedule(0.5, 0.25))
    return f"{record.status.name} {record.states.mean_radius.tobytes().hex()}"


CYCLE = f"""
import numpy as np
from crackfront import core

{inspect.getsource(cycle)}
print(cycle())
{OTHERS}
"""

UNCHANGED = """
import os, signal, sys, warnings
import numba, numpy as np, rocket_fft, scipy.interpolate, scipy.ndimage, scipy.special

def settings():
    public = {name: repr(value) for name, value in vars(numba.config).items() if name.isupper()}
    handlers = {number: signal.getsignal(number) for number in signal.valid_signals()}
    return (public, handlers, list(warnings.filters), np.geterr(), dict(os.environ),
            list(sys.path), sys.getswitchinterval(), np.get_printoptions())

before = settings()
"""


def output(program):
    """What a fresh interpreter prints."""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_what_is_blocked_cannot_be_imported():
    done = subprocess.run(
        [sys.executable, "-c", f"{ALONE}import xarray"], capture_output=True, text=True
    )
    assert "xarray is blocked" in done.stderr


IMPORTS = """
import importlib

for name in ("crackfront", "crackfront.core", "crackfront.core.cycle.run"):
    importlib.import_module(name)
    assert settings() == before, (name, settings(), before)
from crackfront import core
assert all(getattr(core, name) for name in core.__all__)
assert settings() == before, (settings(), before)
"""


@pytest.mark.slow
def test_the_core_runs_without_any_other_library_and_its_import_changes_nothing():
    printed = output(f"{ALONE}{UNCHANGED}{IMPORTS}{CYCLE}")
    assert printed == f"{cycle()}\n"
    assert printed.startswith("LOST_CONTACT")


def test_the_face_names_what_it_has_and_refuses_the_rest():
    assert set(core.__all__) <= set(dir(core))
    assert 10 <= len(core.__all__) <= 15
    with pytest.raises(AttributeError, match="contact_fields"):
        core.contact_fields  # noqa: B018
