"""Modules that are executed when they are first used, though others import them at once."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from importlib.machinery import ModuleSpec
from typing import Any


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
            spec.loader = importlib.util.LazyLoader(spec.loader)
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
