"""The core stands alone: a cycle runs where nothing but numpy, scipy and numba is installed."""

import subprocess
import sys

import numpy as np

from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import tile_field
from crackfront.core.geometry.sphere import sphere

ALONE = """
import importlib.abc, importlib.machinery, sys

class Blocked(importlib.abc.MetaPathFinder):
    names = set("{blocked}".split())

    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in self.names:
            raise ModuleNotFoundError(f"{{name}} is blocked")

sys.meta_path.insert(0, Blocked())
import numpy as np
from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import tile_field
from crackfront.core.geometry.sphere import sphere

noise = np.random.default_rng(1).standard_normal((16, 16)) / 5
field = tile_field(chemical_adhesion(noise, 0.2), sphere(24), 0.1, 3.0)
record = run_cycle(field, LoadSchedule(0.5, 0.25))
print(record.status.name, record.states.mean_radius.tobytes().hex())
others = [name for name in sys.modules if name.startswith("crackfront.")
          and not name.startswith("crackfront.core")]
assert not others, others
"""

BLOCKED = (
    "xarray netCDF4 mpi4py snakemake matplotlib pandas click yaml pint tqdm finufft PIL "
    "SurfaceTopography"
)


def test_a_cycle_runs_where_no_other_library_can_be_imported():
    code = ALONE.format(blocked=BLOCKED)
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300
    )
    noise = np.random.default_rng(1).standard_normal((16, 16)) / 5
    field = tile_field(chemical_adhesion(noise, 0.2), sphere(24), 0.1, 3.0)
    record = run_cycle(field, LoadSchedule(0.5, 0.25))
    name, radii = done.stdout.split()
    assert name == record.status.name == "LOST_CONTACT"
    assert radii == record.states.mean_radius.tobytes().hex()
    assert record.states.mean_radius.size > 5


def test_what_is_blocked_cannot_be_imported():
    code = ALONE.format(blocked=BLOCKED).partition("import numpy")[0] + "import xarray"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert "xarray is blocked" in done.stderr
