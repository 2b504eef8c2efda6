"""What a store holds, lacks and no longer needs of a list of simulations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from crackfront.analysis.table import SweepRow
from crackfront.data.files import UnreadableFileError
from crackfront.simulate.files import read_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.ledger import Ledger
from crackfront.sweep.table import sweep_row


@dataclass(frozen=True, slots=True)
class Stale:
    """A simulation that is stored as it was asked for earlier.

    Attributes
    ----------
    label : str
        Label of the simulation.
    changed : tuple of str
        Which parts of its key have changed since.
    """

    label: str
    changed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks.

    Attributes
    ----------
    missing : tuple of Simulation
        Simulations without a row.
    unreadable : tuple of str
        A sentence for every file that is there and of no use.
    stale : tuple of Stale
        Those of the missing that are stored with another key.
    """

    missing: tuple[Simulation, ...]
    unreadable: tuple[str, ...]
    stale: tuple[Stale, ...]

    def stale_sentence(self) -> str:
        """How many are stale for which reason; empty where none is."""
        reasons = Counter(" and ".join(item.changed) for item in self.stale)
        told = ", ".join(
            f"{count} as {reason} changed" for reason, count in sorted(reasons.items())
        )
        return f"{len(self.stale)} stored simulations are stale: {told}" if told else ""


@dataclass(frozen=True, slots=True)
class Holding:
    """What a store has of one simulation.

    Attributes
    ----------
    simulation : Simulation
        The simulation.
    row : SweepRow or None
        Its row, where it is stored.
    unreadable : str
        A sentence where its file is there and of no use, else empty.
    """

    simulation: Simulation
    row: SweepRow | None
    unreadable: str = ""


def holdings(
    folder: Path, simulations: Iterable[Simulation], ledger: Ledger | None = None
) -> Iterator[Holding]:
    """What a store has of simulations, one after the other.

    Parameters
    ----------
    folder : Path
        Folder of the store.
    simulations : iterable of Simulation
        What to look for.
    ledger : Ledger, optional
        The rows of its journals, where they have been found before.
    """
    curves = folder / "curves"
    for simulation, row in (ledger or Ledger(folder)).rows(simulations):
        if row is not None:
            yield Holding(simulation, row)
            continue
        path = curves / f"{simulation.stem}.nc"
        if not path.is_file():
            yield Holding(simulation, None)
            continue
        try:
            yield Holding(simulation, sweep_row(read_simulation(path, simulation)))
        except UnreadableFileError as error:
            yield Holding(simulation, None, str(error))


def inventory(folder: Path, simulations: Iterable[Simulation]) -> Inventory:
    """What a store lacks of simulations, and why.

    Parameters
    ----------
    folder : Path
        Folder of the store.
    simulations : iterable of Simulation
        What to look for.
    """
    ledger = Ledger(folder)
    absent = [one for one in holdings(folder, simulations, ledger) if one.row is None]
    missing = tuple(one.simulation for one in absent)
    return Inventory(
        missing,
        unreadable=tuple(one.unreadable for one in absent if one.unreadable),
        stale=tuple(
            Stale(
                one.label,
                tuple(name for name, part in one.parts.items() if part != known.get(name)),
            )
            for one in missing
            if (known := ledger.parts(one.label)) is not None
        ),
    )
