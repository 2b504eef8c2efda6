"""Fingerprints of sources: the modules that a result comes from, and a digest of each.

A module comes into a fingerprint when one that is in it imports it, anywhere in its source.
Docstrings, comments and the layout of lines do not count, nor does what is imported for annotations
alone, under `if TYPE_CHECKING`. The file of data that has a module's name, `laws.csv` beside
`laws.py`, counts with the module.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import json
from collections.abc import Collection, Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
"""Folder of the packages."""

_PACKAGES = ("crackfront", "studies")
"""Packages whose modules count; other libraries have versions."""

_SUFFIXES_OF_DATA = (".csv", ".json")


def fingerprint(*modules: str, without: Collection[str] = ()) -> str:
    """Twelve hexadecimal digits that change with the modules that some modules import.

    It is the digest of :func:`module_digests`, which says what it is made of.

    Parameters
    ----------
    *modules : str
        Full names, as "crackfront.core.units".
    without : collection of str, optional
        Modules and packages that do not count, nor what only they import.

    Returns
    -------
    str
        Twelve hexadecimal digits.

    Raises
    ------
    ValueError
        If there is no module of a name.

    Examples
    --------
    >>> fingerprint("crackfront.core.units") == fingerprint("crackfront.core.jkr")
    False
    """
    return _digest(json.dumps(module_digests(*modules, without=without)).encode())[:12]


def module_digests(*modules: str, without: Collection[str] = ()) -> dict[str, str]:
    """Digest of some modules and of every module of the packages that they import.

    Parameters
    ----------
    *modules : str
        Full names, as "crackfront.core.units".
    without : collection of str, optional
        Modules and packages that do not count, nor what only they import.

    Returns
    -------
    dict
        SHA-256 of each module without docstrings and comments, in hexadecimal digits, by its full
        name, in alphabetical order.

    Raises
    ------
    ValueError
        If there is no module of a name.

    Examples
    --------
    >>> list(module_digests("crackfront.core.jkr"))
    ['crackfront.core.arrays', 'crackfront.core.jkr', 'crackfront.core.units']
    """
    found: dict[str, str] = {}
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        if name in found or any(f"{name}.".startswith(f"{one}.") for one in without):
            continue
        path = _path(name, ROOT)
        if path is None:
            raise ValueError(f"there is no module {name}; correct the name")
        meaning, imported = _parsed_source(path.read_bytes())
        data = (path.with_suffix(suffix) for suffix in _SUFFIXES_OF_DATA)
        parts = [meaning, *(_digest(one.read_bytes()) for one in data if one.is_file())]
        found[name] = _digest("".join(parts).encode())
        waiting += filter(None, map(_module_of, imported))
    return dict(sorted(found.items()))


@functools.cache
def solver_fingerprint() -> str:
    """Twelve hexadecimal digits that change with what determines the fronts of a simulation."""
    parts = "cycle.run", "geometry.line", "geometry.sphere", "solver.relax"
    return fingerprint(*(f"crackfront.core.{part}" for part in parts))


def _digest(content: bytes) -> str:
    """SHA-256 of bytes, in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


@functools.cache
def _path(name: str, root: Path) -> Path | None:
    """Source of a module or package of a full name in a folder; None where there is none."""
    place = root / name.replace(".", "/")
    candidates = place.with_suffix(".py"), place / "__init__.py"
    return next(filter(Path.is_file, candidates), None)


def _module_of(imported: str) -> str | None:
    """Module of what an import names: itself or what defines it; None outside the packages."""
    if imported.partition(".")[0] not in _PACKAGES:
        return None
    return imported if _path(imported, ROOT) else imported.rpartition(".")[0]


@functools.lru_cache(maxsize=512)
def _parsed_source(content: bytes) -> tuple[str, list[str]]:
    """Digest of what a source executes, and the full names that it imports."""
    tree = _Executed().visit(ast.parse(content))
    return _digest(ast.dump(tree).encode()), sorted(set(_imported_names(tree)))


def _imported_names(tree: ast.AST) -> Iterator[str]:
    """Full names of what import statements name, wherever they stand."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


class _Executed(ast.NodeTransformer):
    """Removes what does nothing when a program runs: docstrings, and imports for annotations."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        """A statement that is an expression, which goes if it is a text."""
        is_text = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        return None if is_text else node

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        """A condition, which goes if it is TYPE_CHECKING."""
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            return node.orelse
        return self.generic_visit(node)
