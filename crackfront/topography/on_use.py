"""A package that is executed when something of it is used, for a command that ends soon."""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType
from typing import Any

# Its first use would be by a part of itself, which must not be executed twice.
import numpy as np  # noqa: F401


class _Waiting(ModuleType):
    """A package that is executed when something is read that its submodules do not hold."""

    def __getattr__(self, name: str) -> Any:
        self.__class__ = ModuleType  # type: ignore[assignment]
        try:
            self.__spec__.loader.exec_module(self)  # type: ignore[union-attr]
        except BaseException:
            self.__class__ = _Waiting
            raise
        return getattr(self, name)


def import_without_executing(name: str) -> None:
    """Import a package such that its submodules can be imported before it is executed."""
    if name not in sys.modules and (spec := importlib.util.find_spec(name)) is not None:
        sys.modules[name] = module = importlib.util.module_from_spec(spec)
        module.__class__ = _Waiting
        parent, _, child = name.rpartition(".")
        if parent:
            setattr(sys.modules[parent], child, module)
    importlib.import_module(name)
