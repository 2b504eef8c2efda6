"""Both solvers on the problems of the registry: times, memory, and how much the fronts differ."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import RayField, TileField
from crackfront.core.resources import peak_memory
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.solver.relax import SOLVERS
from crackfront.core.variables import ADHESION, variable
from studies.speed.problems import Problem
from studies.tables import Table, make_table


@dataclass(frozen=True, slots=True)
class Row:
    """Both solvers on one problem; times are the least of the repeats."""

    group: str = variable("table of the problem", "1")
    label: str = variable("problem", "1")
    rms: float = variable("rms of the local work of adhesion", ADHESION)
    status: str = variable("how its cycle ended", "1")
    n_cutoff: float = variable("sites times short cutoffs crossed", "1")
    reference_seconds: float = variable("processor time of the reference", "s")
    newton_seconds: float = variable("processor time of the fast solver", "s")
    reference_pairs: int = variable("pairs of FFTs of the reference", "1")
    newton_pairs: int = variable("pairs of FFTs of the fast solver", "1")
    reference_updates: int = variable("updates of single sites of the reference", "1")
    newton_updates: int = variable("updates of single sites of the fast solver", "1")
    error: float = variable("largest difference of the fronts", "short cutoff")
    memory: float = variable("largest resident memory of the problem's process", "MB")

    @property
    def ratio(self) -> float:
        """How many times faster the fast solver is."""
        return self.reference_seconds / self.newton_seconds


def timed_cycle(
    field: RayField | TileField, schedule: LoadSchedule, solver: str
) -> tuple[float, CycleRecord]:
    """CPU seconds of a cycle, and its record."""
    start = time.process_time()
    record = run_cycle(field, schedule, SOLVERS[solver](DEFAULT_TOLERANCE), Recorder(fronts=True))
    return time.process_time() - start, record


def measured(problem: Problem, seed: int, repeats: int) -> Row:
    """Both solvers, in turn on one realisation."""
    for solver in ("reference", "newton"):
        timed_cycle(problem.smallest().field(0), LoadSchedule(0.0, 1.0), solver)
    field = problem.field(seed)
    runs = [
        [timed_cycle(field, problem.schedule, solver) for solver in ("reference", "newton")]
        for _ in range(repeats)
    ]
    (_, reference), (_, newton) = runs[0]
    if reference.fronts is None or newton.fronts is None or reference.status != newton.status:
        raise RuntimeError(f"{problem.label}: the solvers end with different states")
    cutoff = problem.spectrum.short_cutoff
    travel = 2 * float(reference.states.max_radius.max())
    return Row(
        group=problem.group,
        label=problem.label,
        rms=problem.rms,
        status=newton.status.name.lower(),
        n_cutoff=problem.n_angle * travel / cutoff,
        reference_seconds=min(run[0][0] for run in runs),
        newton_seconds=min(run[1][0] for run in runs),
        reference_pairs=int(reference.states.iterations.sum()),
        newton_pairs=int(newton.states.iterations.sum()),
        reference_updates=int(reference.states.updates.sum()),
        newton_updates=int(newton.states.updates.sum()),
        error=float(np.max(np.abs(newton.fronts - reference.fronts))) / cutoff,
        memory=1e-6 * peak_memory(),
    )


def solver_table(rows: Sequence[Row], repeats: int) -> Table:
    """Both solvers on all problems, and how their times grow."""
    text = (
        "One process, one core; both solvers in turn on the same field, tolerance "
        f"{DEFAULT_TOLERANCE:g} w_int, penetration 0 to 1 and back to pull-off; CPU seconds, the "
        f"least of {repeats} runs. Updates are a site and cutoff. The error is the largest "
        "difference of the fronts over all load steps, in short cutoffs."
    )
    if exponents := _exponents(rows):
        text += f" Exponents of the time in sites times cutoffs crossed: {exponents}."
    return make_table(
        "group | problem | reference s | newton s | ratio | FFT pairs of reference "
        "| FFT pairs of newton | updates of reference | updates of newton "
        "| newton us a site and cutoff | error | MB",
        (
            (
                row.group,
                row.label,
                f"{row.reference_seconds:.2f}",
                f"{row.newton_seconds:.2f}",
                f"{row.ratio:.1f}",
                f"{row.reference_pairs}",
                f"{row.newton_pairs}",
                f"{row.reference_updates / row.n_cutoff:.1f}",
                f"{row.newton_updates / row.n_cutoff:.1f}",
                f"{1e6 * row.newton_seconds / row.n_cutoff:.2f}",
                f"{row.error:.1e}",
                f"{row.memory:.0f}",
            )
            for row in rows
        ),
        text,
    )


def _exponents(rows: Iterable[Row]) -> str:
    """How the time grows with sites times cutoffs crossed, at every disorder."""
    texts = []
    scaling = [row for row in rows if row.group == "scaling"]
    for rms in dict.fromkeys(row.rms for row in scaling):
        chosen = [row for row in scaling if row.rms == rms]
        crossed = np.log([row.n_cutoff for row in chosen])
        seconds = np.log([(row.reference_seconds, row.newton_seconds) for row in chosen])
        reference, newton = np.polyfit(crossed, seconds, 1)[0]
        texts.append(f"w_rms {rms:g}: reference {reference:.2f}, newton {newton:.2f}")
    return "; ".join(texts)
