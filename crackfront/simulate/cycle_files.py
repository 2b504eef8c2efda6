"""Files of single cycles: their curves and costs, and the checkpoints of runs."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.core.cycle.jumps import Jumps, jump_variables
from crackfront.core.cycle.record import Checkpoint, CycleRecord
from crackfront.core.geometry.base import Geometry, State
from crackfront.core.geometry.line import LineState
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status
from crackfront.core.variables import STEP, Variable, variables
from crackfront.core.versions import PHYSICS_VERSION
from crackfront.simulate.checksums import digest_path, file_digest, sums_text
from crackfront.simulate.labels import labelled, labelled_fields
from crackfront.simulate.provenance import Provenance, provenance
from crackfront.simulate.run_simulation import PartialRun
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.storage import (
    UnreadableFileError,
    read_dataset,
    set_aside_if_damaged,
    write_dataset,
    write_named_by_digest,
    write_text,
)

_FRONTS = {
    "front": ("last_front", "front of the last state"),
    "turn": ("turning_front", "front at which its branch began"),
    "resolved": ("resolved_front", "last front on which jumps were resolved"),
}
"""Names and meanings of the fronts of a checkpoint, by their fields."""

_NEEDED_FRONTS = {"last_front", "turning_front"}
"""Fronts that every checkpoint has."""

_LOOP_STATES: tuple[type[State], ...] = (ContactState, LineState)
"""Records of the states of loops on a user's surface; a file has the load of one of them."""

_STEP = Variable(STEP, (STEP,), "1", "number of the state")


@dataclass(frozen=True, slots=True)
class CycleCheckpoint:
    """File with the states of an interrupted cycle, from which the same cycle continues."""

    path: Path
    key: str
    """Digest of all that determines the cycle."""
    geometry: Geometry

    def read(self, warn: Callable[[str], None]) -> Checkpoint | None:
        """Stored checkpoint; None if there is none, or if it is damaged, of which a sentence warns.

        ValueError if the file is the checkpoint of another cycle.
        """
        if not self.path.exists():
            return None
        if digest_path(self.path).exists() and (sentence := set_aside_if_damaged(self.path)):
            warn(f"{sentence}; the cycle begins anew")
            return None
        states = self.geometry.state_type
        checkpoint = _matching_checkpoint(read_dataset(self.path), self.key, states, self.path)
        if checkpoint is None:
            raise ValueError(
                f"{self.path} has the states of another cycle: the field, an option or the version "
                "differs; remove it, or name another --output"
            )
        return checkpoint

    def write(self, checkpoint: Checkpoint) -> None:
        """Write a checkpoint, in place of an earlier one.

        The checksum is absent meanwhile: after a kill, whichever file is there is whole.
        """
        dataset = _checkpoint_dataset(checkpoint, self.key, self.geometry)
        digest = digest_path(self.path)
        digest.unlink(missing_ok=True)
        write_dataset(self.path, dataset, provenance())
        write_text(digest, sums_text({self.path.name: file_digest(self.path)}))

    def remove(self) -> None:
        """Remove the file and its checksum."""
        for path in (self.path, digest_path(self.path)):
            path.unlink(missing_ok=True)


def checkpoint_path(output: Path) -> Path:
    """Path of the checkpoint of a cycle whose states are written into an output."""
    return output.with_name(f"{output.stem}.checkpoint.nc")


def cycle_key(field_file: Path, *options: object) -> str:
    """Digest of a field, the options of a cycle and the version of the physics."""
    content = file_digest(field_file)
    return hashlib.sha256(repr((content, *options, PHYSICS_VERSION)).encode()).hexdigest()


def write_checkpoint(folder: Path, name: str, partial: PartialRun, origin: Provenance) -> Path:
    """Write the checkpoint of a simulation, from which it goes on later; its name has a digest."""
    simulation = partial.simulation
    dataset = _checkpoint_dataset(partial.checkpoint, simulation.key, simulation.geometry)
    costs = {"seconds": partial.seconds, "cpu_seconds": partial.cpu_seconds}
    about = {"simulation": simulation.label} | costs
    return write_named_by_digest(folder, name, dataset.assign_attrs(about), origin)


def _checkpoint_dataset(checkpoint: Checkpoint, key: str, geometry: Geometry) -> xr.Dataset:
    """Dataset of the checkpoint of a key."""
    front, _ = geometry.variables
    fronts = {
        name: labelled(replace(front, name=name, long_name=text), getattr(checkpoint, field))
        for field, (name, text) in _FRONTS.items()
        if getattr(checkpoint, field) is not None
    }
    return cycle_dataset(checkpoint.record, geometry).assign(fronts).assign_attrs(key=key)


def read_checkpoint(path: Path, simulation: Simulation) -> PartialRun:
    """Stored checkpoint of a simulation; UnreadableFileError if it is of another one."""
    dataset = read_dataset(path)
    states = simulation.geometry.state_type
    checkpoint = _matching_checkpoint(dataset, simulation.key, states, path)
    if checkpoint is None or dataset.attrs["physics_version"] != PHYSICS_VERSION:
        raise UnreadableFileError(f"{path} is not a checkpoint of {simulation.label}; move it away")
    costs = (float(dataset.attrs[name]) for name in ("seconds", "cpu_seconds"))
    return PartialRun(simulation, checkpoint, *costs)


def _matching_checkpoint(
    dataset: xr.Dataset, key: str, states: type[State], place: Path
) -> Checkpoint | None:
    """Checkpoint that :func:`_checkpoint_dataset` made a dataset of; None where its key differs."""
    if dataset.attrs.get("key") != key or not dataset.variables.keys() >= _NEEDED_FRONTS:
        return None
    fronts = {
        field: np.asarray(dataset[name]) for field, (name, _) in _FRONTS.items() if name in dataset
    }
    return Checkpoint(cycle_record(dataset, place, states), **fronts)


def cycle_dataset(record: CycleRecord, geometry: Geometry) -> xr.Dataset:
    """Labelled curves of a record."""
    curves = labelled_fields(record.states, STEP) | labelled_fields(record)
    if record.jumps is not None:
        curves |= {
            item.name: labelled(item, getattr(record.jumps, item.name))
            for item in jump_variables(type(record.states))
        }
    curves[STEP] = labelled(_STEP, np.arange(record.states.direction.size))
    if record.fronts is not None:
        front, site = geometry.variables
        curves[front.name] = labelled(replace(front, dims=(STEP, *front.dims)), record.fronts)
        curves[site.name] = labelled(site, geometry.sites)
    load = variables(type(record.states))[0].name
    attributes: dict[str, str | float] = {
        "title": "states of a crack front from load to load",
        "status": record.status.name.lower(),
        "status_sentence": record.status.value,
        f"end_{load}": record.end_load,
    }
    if record.pull_off_energy is not None:
        attributes["pull_off_energy"] = record.pull_off_energy
    return xr.Dataset(curves, attrs=attributes)


def cycle_record(
    dataset: xr.Dataset, place: Path | str = "the dataset", states: type[State] | None = None
) -> CycleRecord:
    """Record in a dataset of :func:`cycle_dataset`, or `UnreadableFileError`.

    `states` is the record of its states; without it, the dataset is a loop on a user's surface
    with the states of a sphere or a straight front.
    """
    if states is None:
        loops = (kind for kind in _LOOP_STATES if variables(kind)[0].name in dataset)
        states = next(loops, ContactState)
    names = [item.name for item in variables(states)]
    missing = [name for name in names if name not in dataset]
    name = str(dataset.attrs.get("status", "")).upper()
    end = f"end_{names[0]}"
    if missing or name not in Status.__members__ or end not in dataset.attrs:
        lacking = ", ".join(missing) or "a known status"
        raise UnreadableFileError(
            f"{place} is not a loop: it lacks {lacking}; give what run_loop returned or crackfront "
            "cycle wrote"
        )
    pull_off = dataset.attrs.get("pull_off_energy")
    jumps = None
    if "jump_area" in dataset:
        jumps = Jumps(**{item.name: np.asarray(dataset[item.name]) for item in variables(Jumps)})
    fronts = dataset.get(states.front_name)
    lost = dataset.get("dissipated_energy")
    return CycleRecord(
        status=Status[name],
        end_load=float(dataset.attrs[end]),
        states=states(**{name: np.asarray(dataset[name]) for name in names}),
        dissipated_energy=None if lost is None else np.asarray(lost),
        pull_off_energy=None if pull_off is None else float(pull_off),
        fronts=None if fronts is None else np.asarray(fronts),
        jumps=jumps,
    )
