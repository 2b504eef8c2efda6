"""A sweep in the library: begun or continued, one simulation after the other, to its table."""

from __future__ import annotations

import contextlib
import os
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from tqdm import tqdm
from xarray import Dataset

from crackfront.simulate.labels import flag_words
from crackfront.simulate.provenance import Provenance, provenance
from crackfront.simulate.storage import read_derived, write_text
from crackfront.sweep.feasibility import check_feasible
from crackfront.sweep.finished_shards import finish_shard
from crackfront.sweep.parallel import deferring_stops
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.results_folder import (
    SOURCE,
    check_configuration,
    check_layout,
    results_folder,
)
from crackfront.sweep.rows import COMPLETE
from crackfront.sweep.section import movable_text
from crackfront.sweep.shard_locks import Announce
from crackfront.sweep.store import Store
from crackfront.sweep.sweep import Sweep
from crackfront.sweep.tasks import run_and_store
from crackfront.validation import PathName, checked_call


def opened(
    configuration: Path, output: Path | None, announce: Announce = warnings.warn
) -> tuple[Sweep, Store, Provenance]:
    """Sweep of a configuration file, its store, and the origin of what is computed for it.

    ConfigurationError if no machine can run the sweep, or the results belong to another
    configuration that is still there, or have an older layout.
    """
    sweep = load_sweep(configuration)
    check_feasible(sweep, configuration)
    if output is not None and output.exists() and not output.is_dir():
        raise ValueError(f"the output is {output}, a file; name a folder for the results")
    store = Store(results_folder(configuration) if output is None else output, announce)
    check_layout(store.folder)
    check_configuration(configuration, store.folder)
    return sweep, store, provenance(movable_text(configuration))


@checked_call
def run_sweep(
    configuration: PathName,
    output: PathName | None = None,
    *,
    progress: bool = True,
) -> Dataset:
    """Table of a sweep; what is not stored yet is run here, one simulation after the other.

    `crackfront simulate` runs the same on many ranks, into the same folder.

    Parameters
    ----------
    configuration : str or path
        File of the sweep, as config/default.yaml.
    output : str or path, optional
        Folder of the results, by default results/<name of the configuration>.
    progress : bool, optional
        Whether a bar on standard error shows how far it is.

    Returns
    -------
    xarray.Dataset
        w_appr, w_retr, their errors, status and costs over `spectrum`, `amplitude` and
        `realisation`, as in hysteresis.nc.

    Raises
    ------
    ValueError
        If the configuration cannot be used.
    TypeError
        If an argument is of another type.
    OSError
        If nothing can be stored.
    KeyboardInterrupt
        After Ctrl-C or SIGTERM. Finished simulations are stored; the same call continues.
    """
    sweep, store, origin = opened(configuration, output)
    shards = sweep.shards()
    write_source(configuration, store.folder)
    with deferring_stops(), store.locked(shards):
        lacking = [(shard, store.unfinished(sweep, [shard]).simulations()) for shard in shards]
        n_missing = sum(len(simulations) for _, simulations in lacking)
        bar = tqdm(total=n_missing, unit="simulation", disable=not (progress and n_missing))
        with (
            bar,
            contextlib.closing(run_and_store(store, lacking, origin)) as outcomes,
        ):
            for _ in outcomes:
                bar.update()
        for shard in shards:
            finish_shard(store, sweep, shard, origin)
    table = store.aggregate(sweep, origin)
    failed, sentence = without_value(table)
    if failed:
        warnings.warn(sentence, stacklevel=2)
    return read_derived(table)


def write_source(configuration: Path, results: Path) -> None:
    """State in a folder of results of which configuration they are."""
    write_text(results / SOURCE, f"{os.path.relpath(configuration, results)}\n")


def without_value(table: Path) -> tuple[int, str]:
    """How many simulations of a table have no value, and how most of them ended, with a remedy."""
    dataset = read_derived(table, ("status", "status_sentence"))
    words, sentences = flag_words(dataset.status), dataset.status_sentence.values
    failed = ~np.isin(words, COMPLETE)
    by_status, by_sentence = (Counter(values[failed].tolist()) for values in (words, sentences))
    listed = ", ".join(f"{count} {status}" for status, count in sorted(by_status.items()))
    reasons = "; ".join(f"{count}: {text}" for text, count in by_sentence.most_common(3))
    count = int(np.count_nonzero(failed))
    return count, f"{count} of {failed.size} simulations have no value: {listed} ({reasons})"
