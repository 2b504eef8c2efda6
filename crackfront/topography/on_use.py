"""Packages that are executed when something of them is used, for a command that ends soon."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

# Its first use would be by a part of itself, which must not be executed twice.
import numpy as np  # noqa: F401


class _Finder(PathFinder):
    """Finder of packages that wait for their first use."""

    @classmethod
    def find_spec(
        cls,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        spec = super().find_spec(fullname, path, target)
        if spec is not None and spec.loader is not None and spec.submodule_search_locations:
            spec.loader = importlib.util.LazyLoader(spec.loader)
        return spec


@contextmanager
def packages_on_use() -> Iterator[None]:
    """Import packages, and execute only those of which something is used."""
    sys.meta_path.insert(0, _Finder)
    try:
        yield
    finally:
        sys.meta_path.remove(_Finder)


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
