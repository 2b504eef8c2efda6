"""How the jobs of a sweep share the cores of a machine."""

from __future__ import annotations

from collections.abc import Sequence

_JOB_SECONDS = 5.0
"""What a job over all cores takes beside its simulations: ranks start, and the last one is waited
for. Of the five jobs of `config/default.yaml` on two cores it is 27 s. (Units: s)"""


def cores_of_job(
    seconds: Sequence[float], longest: Sequence[float], n_core: int, n_held: float
) -> int:
    """Cores of every job: all, or one where jobs side by side end earlier.

    Parameters
    ----------
    seconds
        Expected processor time of each job (Units: s). Side by side the longest start first.
    longest
        That of the longest simulation of each job, before which no job ends (Units: s).
    n_core
        Cores of the machine.
    n_held
        Simulations that the memory of the machine holds at once. Where these are fewer than cores,
        no jobs run side by side; the one job then says what it lacks.

    Returns
    -------
    int
        1 or `n_core`.
    """
    if n_held < n_core:
        return n_core
    ends = [0.0] * n_core
    for one in sorted(seconds, reverse=True):
        ends[ends.index(min(ends))] += one
    spread = map(max, longest, (one / n_core for one in seconds))
    in_turn = sum(spread) + _JOB_SECONDS * len(seconds)
    return 1 if max(ends) < in_turn else n_core
