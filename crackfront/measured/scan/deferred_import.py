"""Packages of others, imported without what is not used of them.

SurfaceTopography imports all its formats and analyses, and `crackfront predict` needs a few: with
the whole package it takes 3.4 s of processor time in place of 2.0 s. NuMPI starts MPI, or takes the
communicator of ranks that run, where scans are read by one process.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import sys
from types import ModuleType
from typing import Any

# Its first use would be by a part of itself, which must not be executed twice.
import numpy as np  # noqa: F401


class _Deferred(ModuleType):
    """A package that is executed at the first use of any name but its imported submodules."""

    def __getattr__(self, name: str) -> Any:
        self.__class__ = ModuleType  # type: ignore[assignment]
        try:
            self.__spec__.loader.exec_module(self)  # type: ignore[union-attr]
        except BaseException:
            self.__class__ = _Deferred
            raise
        return getattr(self, name)


def import_without_executing(name: str) -> None:
    """Import a package such that its submodules can be imported before it is executed."""
    if name not in sys.modules and (spec := importlib.util.find_spec(name)) is not None:
        sys.modules[name] = module = importlib.util.module_from_spec(spec)
        module.__class__ = _Deferred
        parent, _, child = name.rpartition(".")
        if parent:
            setattr(sys.modules[parent], child, module)
    importlib.import_module(name)


def import_without_mpi() -> None:
    """Import NuMPI with its own stub of MPI, as NuMPI does without mpi4py.

    MPI may fail to start on nodes without jobs.
    """
    name = "NuMPI"
    if name in sys.modules or (spec := importlib.util.find_spec(name)) is None:
        return
    sys.modules[name] = module = importlib.util.module_from_spec(spec)
    try:
        stub = importlib.import_module(f"{name}.MPIStub")
        vars(module).update(
            MPI=stub, _has_mpi4py=False, __version__=importlib.metadata.version(name)
        )
        for part in ("Optimization", "Tools"):
            importlib.import_module(f"{name}.{part}")
    except BaseException:
        del sys.modules[name]
        raise
