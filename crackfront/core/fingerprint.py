"""Fingerprints of sources by their meaning: what cannot change a number does not change them.

Documentation, comments, annotations, imports and the places of definitions do not count. A name
to which several modules give different meanings is told apart by its module. What was found of the
same bytes before is kept in the cache of this user, as parsing the package takes a second.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import hashlib
import os
import re
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from crackfront.core.private_cache import caches, is_private

PACKAGE = Path(__file__).parents[1]

SOLVER = ("core",)
"""Folders whose sources determine the fronts of a simulation."""

NO_PART = ("core/cycle/instabilities.py",)
"""Sources there that no simulation uses."""


def fingerprint(
    *places: str, without: Sequence[str] = (), reached: Mapping[str, Sequence[str]] | None = None
) -> str:
    """Twelve hexadecimal digits that change with the meaning of sources, or with data.

    Parameters
    ----------
    *places : str
        Files or folders of the package. What is no Python counts byte by byte.
    without : sequence of str, optional
        Files that do not count.
    reached : mapping, optional
        Files of which only some names count, with all that these reach within the file.

    Examples
    --------
    >>> fingerprint("core/units.py") == fingerprint("core/units.py", "core/__init__.py")
    True
    """
    skipped = {PACKAGE / place for place in without}
    paths = {path for place in places for path in _files(PACKAGE / place)} - skipped
    chosen = {PACKAGE / place: names for place, names in (reached or {}).items()}
    contents = {path: path.read_bytes() for path in sorted(paths | set(chosen))}
    kept = _kept_in(contents, chosen)
    with contextlib.suppress(OSError, ValueError):
        if kept is not None and _DIGITS.fullmatch(known := kept.read_text("ascii")):
            return known
    found = _meaning(contents, chosen)
    if kept is not None:
        with contextlib.suppress(OSError):
            part = kept.with_name(f"{kept.name}.{os.getpid()}")
            part.write_text(found, "ascii")
            part.replace(kept)
    return found


_DIGITS = re.compile("[0-9a-f]{12}")


def _kept_in(contents: Mapping[Path, bytes], chosen: Mapping[Path, Sequence[str]]) -> Path | None:
    """File that keeps the fingerprint of these bytes; None where this user has no cache."""
    folder = next((parent / "fingerprints" for parent in caches() if is_private(parent)), None)
    if folder is None or not is_private(folder):
        return None
    digest = hashlib.sha256(Path(__file__).read_bytes())
    # Which modules there are tells them from other names; trees differ between Pythons.
    modules = sorted(str(path.relative_to(PACKAGE)) for path in PACKAGE.rglob("*.py"))
    names = {str(path.relative_to(PACKAGE)): list(names) for path, names in chosen.items()}
    digest.update(repr((sys.version_info[:2], modules, sorted(names.items()))).encode())
    for path, content in contents.items():
        head = f"{path.relative_to(PACKAGE)} {len(content)}"
        digest.update(head.encode() + content)
    return folder / digest.hexdigest()


def _meaning(contents: Mapping[Path, bytes], chosen: Mapping[Path, Sequence[str]]) -> str:
    """Twelve hexadecimal digits of the meaning of sources, of some of which only names count."""
    sources = {path: ast.parse(text) for path, text in contents.items() if path.suffix == ".py"}
    shared = _shared_names(list(sources.values()))
    parts = [content for path, content in contents.items() if path not in sources]
    for path, tree in sources.items():
        meaning = _Meaning(path.stem, tree, shared)
        kept = _reached(tree, chosen[path]) if path in chosen else tree.body
        parts += [meaning.text(one).encode() for one in kept if not _is_mute(one)]
    digest = hashlib.sha256()
    for part in sorted(hashlib.sha256(part).digest() for part in parts):
        digest.update(part)
    return digest.hexdigest()[:12]


@functools.cache
def solver_fingerprint() -> str:
    """Twelve hexadecimal digits that change with what determines the fronts of a simulation."""
    return fingerprint(*SOLVER, without=NO_PART)


def _files(place: Path) -> Iterator[Path]:
    """A file, or all sources of a folder."""
    return place.rglob("*.py") if place.is_dir() else iter((place,))


def _reached(tree: ast.Module, names: Sequence[str]) -> list[ast.stmt]:
    """Statements of a module that some of its names reach."""
    known = {name: one for one in tree.body for name in _defined(one)}
    found: dict[str, ast.stmt] = {}
    coming = list(names)
    while coming:
        if (name := coming.pop()) in known and name not in found:
            found[name] = known[name]
            nodes = ast.walk(known[name])
            coming += [node.id for node in nodes if isinstance(node, ast.Name)]
    return [one for one in tree.body if any(one is statement for statement in found.values())]


def _shared_names(trees: Sequence[ast.Module]) -> set[str]:
    """Names to which several modules give different meanings."""
    meanings: dict[str, set[str]] = defaultdict(set)
    for statement in (statement for tree in trees for statement in tree.body):
        for name in _defined(statement):
            meanings[name].add(ast.dump(statement))
    return {name for name, texts in meanings.items() if len(texts) > 1}


def _defined(statement: ast.stmt) -> Iterator[str]:
    """Names that a statement at the top of a module defines."""
    if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
        yield statement.name
    for target in getattr(statement, "targets", [getattr(statement, "target", None)]):
        if target is not None:
            yield from (node.id for node in ast.walk(target) if isinstance(node, ast.Name))


class _Meaning:
    """The statements of a module as texts, with names as their modules define them."""

    def __init__(self, module: str, tree: ast.Module, shared: set[str]) -> None:
        self._shared, self._modules = shared, set[str]()
        own = {name for statement in tree.body for name in _defined(statement)}
        self._names = {name: f"{module}.{name}" for name in own & shared}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("crackfront"):
                self._import(node)

    def _import(self, node: ast.ImportFrom) -> None:
        """Note what an import of the package brings."""
        home = str(node.module)
        for alias in node.names:
            source = PACKAGE.parent / home.replace(".", "/") / alias.name
            if source.is_dir() or source.with_suffix(".py").is_file():
                self._modules.add(alias.asname or alias.name)
            else:
                full = f"{home.rpartition('.')[2]}.{alias.name}"
                known = full if alias.name in self._shared else alias.name
                self._names[alias.asname or alias.name] = known

    def text(self, part: object) -> str:
        """A statement, or a part of one, without annotations and what is mute."""
        if isinstance(part, list):
            return f"[{' '.join(self.text(one) for one in part if not _is_mute(one))}]"
        if not isinstance(part, ast.AST):
            return repr(part)
        if isinstance(part, ast.Name):
            return self._names.get(part.id, part.id)
        home = getattr(getattr(part, "value", None), "id", None)
        if isinstance(part, ast.Attribute) and home in self._modules:
            # A name of a module of the package stands for itself, wherever that module lies.
            return f"{home}.{part.attr}" if part.attr in self._shared else part.attr
        if isinstance(part, ast.AnnAssign) and part.value is not None:
            part = ast.Assign([part.target], part.value)
        values = [
            self._names.get(value, value) if name == "name" else self.text(value)
            for name, value in ast.iter_fields(part)
            if name not in ("annotation", "returns", "ctx", "kind", "type_comment")
        ]
        return f"({type(part).__name__} {' '.join(map(str, values))})"


def _is_mute(statement: object) -> bool:
    """Whether a statement is documentation, an import or a condition of type checkers."""
    if isinstance(statement, ast.If):
        return isinstance(statement.test, ast.Name) and statement.test.id == "TYPE_CHECKING"
    text = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    return text or isinstance(statement, (ast.Import, ast.ImportFrom))
