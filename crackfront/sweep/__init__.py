"""Many simulations: configuration, store, MPI ranks, and the table that they become.

The library calls the folder itself: `crackfront.sweep("config.yaml")` is
:func:`crackfront.sweep.library.sweep`, wherever a module of the folder was imported before.
"""

import importlib
import sys
from types import ModuleType
from typing import Any


class _Sweeps(ModuleType):
    """A folder that can be called."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """The table of a sweep."""
        return importlib.import_module("crackfront.sweep.library").sweep(*arguments, **options)


sys.modules[__name__].__class__ = _Sweeps
