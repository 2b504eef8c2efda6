"""A simulation that ends at any state and goes on later is the undisturbed one, bit for bit."""

import contextlib
import functools
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from crackfront.core.versions import PHYSICS_VERSION
from crackfront.simulate.cycle_files import CycleCheckpoint, read_checkpoint, write_checkpoint
from crackfront.simulate.provenance import provenance
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.storage import UnreadableFileError
from crackfront.sweep.parameters import load_sweep

SWEEP = load_sweep(Path(__file__).parents[2] / "config/test.yaml")
LINES = load_sweep(Path(__file__).parents[1] / "line-test.yaml")
CYCLE = replace(
    SWEEP.simulation(SWEEP.spectra[1], 0.1, 0),
    schedule=FullCycle(0.5, 0.125),
    record_fronts=True,
    record_energy=True,
)
STEADY = replace(CYCLE, schedule=SteadySchedule(0.4, 1.2, travel=0.5, standard_error=1e-6))
LINE = replace(LINES.simulation(LINES.spectra[0], 0.16, 1), record_fronts=True)


@functools.cache
def checkpoints(simulation):
    """Undisturbed result of a simulation, and its checkpoint at every state."""
    saved = []
    result = run_simulation(simulation, keep=lambda make: saved.append(make()))
    assert len(saved) == result.record.states.direction.size
    return result, saved


@pytest.mark.parametrize("simulation", [CYCLE, STEADY, LINE], ids=["cycle", "steady", "line"])
def test_a_run_goes_on_from_any_state_to_the_same_bits(tmp_path, simulation):
    undisturbed, saved = checkpoints(simulation)
    directions = undisturbed.record.states.direction
    assert {1, -1} == set(directions.tolist())
    for partial in saved[:: 1 + len(saved) // 10]:
        path = write_checkpoint(tmp_path, "checkpoint", partial, provenance())
        resumed = read_checkpoint(path, simulation)
        computed = []
        result = run_simulation(simulation, resume=resumed, keep=computed.append)
        np.testing.assert_equal(asdict(result.record), asdict(undisturbed.record))
        n_known = partial.checkpoint.record.states.direction.size
        assert len(computed) == directions.size - n_known
        assert result.measures.cpu_seconds > partial.cpu_seconds


def test_a_checkpoint_of_another_load_is_refused():
    _, saved = checkpoints(CYCLE)
    with pytest.raises(ValueError, match="it belongs to other loads"):
        run_simulation(replace(CYCLE, schedule=FullCycle(0.5, 0.25)), resume=saved[5])


def test_a_truncated_checkpoint_and_that_of_another_simulation_are_refused(tmp_path):
    _, saved = checkpoints(CYCLE)
    path = write_checkpoint(tmp_path, "checkpoint", saved[2], provenance())
    with pytest.raises(UnreadableFileError, match="is not a checkpoint of"):
        read_checkpoint(path, STEADY)
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(UnreadableFileError, match="is not a complete netCDF file"):
        read_checkpoint(path, CYCLE)


def test_a_checkpoint_of_another_version_of_the_physics_is_refused(tmp_path, monkeypatch):
    _, partial_runs = checkpoints(CYCLE)
    path = write_checkpoint(tmp_path, "checkpoint", partial_runs[2], provenance())
    monkeypatch.setattr("crackfront.simulate.cycle_files.PHYSICS_VERSION", PHYSICS_VERSION + 1)
    with pytest.raises(UnreadableFileError, match="is not a checkpoint of"):
        read_checkpoint(path, CYCLE)


@pytest.mark.parametrize("n_rename", [0, 1, 2])
def test_a_kill_while_states_of_a_cycle_are_replaced_leaves_some(tmp_path, monkeypatch, n_rename):
    _, saved = checkpoints(CYCLE)
    stored = CycleCheckpoint(tmp_path / "out.checkpoint.nc", "key", CYCLE.geometry)
    stored.write(saved[0].checkpoint)
    rename, renamed = Path.replace, []

    def killed(path, target):
        if len(renamed) == n_rename:
            raise KeyboardInterrupt
        renamed.append(target)
        return rename(path, target)

    with monkeypatch.context() as patched, contextlib.suppress(KeyboardInterrupt):
        patched.setattr(Path, "replace", killed)
        stored.write(saved[1].checkpoint)
    checkpoint = stored.read(pytest.fail)
    assert checkpoint is not None
    assert checkpoint.record.states.direction.size == (1 if n_rename == 0 else 2)
