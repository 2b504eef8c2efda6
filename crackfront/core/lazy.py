"""Lazy imports: a package imports each name that it offers at its first use."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Callable
from pathlib import Path


def lazy_names(package: str) -> tuple[list[str], Callable[[str], object], Callable[[], list[str]]]:
    """`__all__`, `__getattr__` and `__dir__` of a package whose typed imports are what it offers.

    Those are the lines `from module import name as name` of its source, under `TYPE_CHECKING`:
    numba takes half a second to import, xarray a second, and `--help` needs neither.
    """
    module = sys.modules[package]
    source = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    imports = (node for node in ast.walk(source) if isinstance(node, ast.ImportFrom))
    modules = {one.asname: str(node.module) for node in imports for one in node.names if one.asname}

    def offered(name: str) -> object:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(modules[name]), name)

    return sorted(modules), offered, lambda: [*vars(module), *modules]
