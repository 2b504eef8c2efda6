"""Many simulations: configuration, store, MPI ranks, and the table that they become.

The library calls the folder itself: `crackfront.sweep("config.yaml")` is :func:`sweep`, whose
attributes are the modules of the folder.
"""

from __future__ import annotations

import importlib
import sys
from os import PathLike
from types import ModuleType
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from xarray import Dataset


def sweep(
    configuration: str | PathLike[str],
    output: str | PathLike[str] | None = None,
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
    OSError
        If nothing can be stored.
    KeyboardInterrupt
        After Ctrl-C or SIGTERM. Finished simulations are stored; the same call continues.
    """
    found: Dataset = importlib.import_module("crackfront.sweep.library").sweep_table(
        configuration, output, progress=progress
    )
    return found


sweep.__name__ = __name__
sweep.__dict__.update(globals())
# Python imports modules of the folder as attributes of what stands here: of a function, too.
sys.modules[__name__] = cast(ModuleType, sweep)
