"""Modules that are executed when they are first used, though others import them at once."""

from __future__ import annotations

import importlib.util
import sys
import warnings
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any


class _Loader(importlib.util.LazyLoader):
    """Loads a module on use; to be imported a second time, which asks for its spec, is none."""

    def exec_module(self, module: ModuleType) -> None:
        """Make the module wait."""
        super().exec_module(module)
        lazy = type(module)

        class Waiting(lazy):  # type: ignore[misc, valid-type]
            def __getattribute__(self, name: str) -> Any:
                if name == "__spec__":
                    return object.__getattribute__(self, name)
                return super().__getattribute__(name)

        module.__class__ = Waiting


class _Finder:
    """Finds modules of some names such that they load on use."""

    def __init__(self, names: Collection[str]) -> None:
        self.names = names
        self.is_asked = False

    def find_spec(self, name: str, path: Any, target: Any = None) -> ModuleSpec | None:
        """What the other finders say, with a loader that waits."""
        if name not in self.names or self.is_asked:
            return None
        self.is_asked = True
        try:
            spec = importlib.util.find_spec(name)
        finally:
            self.is_asked = False
        if spec is not None and spec.loader is not None:
            spec.loader = _Loader(spec.loader)
        return spec


@contextmanager
def loaded_on_use(names: Collection[str]) -> Iterator[None]:
    """Within, imports of these modules take no time; an attribute of one loads it, at any time."""
    finder = _Finder(names)
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)


@contextmanager
def unavailable(name: str) -> Iterator[None]:
    """Within, a module cannot be imported, and that others do without it is no warning."""
    known = sys.modules.get(name)
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImportWarning)
            yield
    finally:
        reveal(name)
        if known is not None:
            sys.modules[name] = known


def reveal(name: str) -> None:
    """Let a module that is unavailable be found again."""
    if sys.modules.get(name) is None:
        sys.modules.pop(name, None)
