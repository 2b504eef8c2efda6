"""Fingerprints of sources: what a result comes from, found by following names through imports.

A definition counts if a named one reaches it by names, attributes and imports, a class also if an
annotation names it. Documentation, comments, annotations, imports and the places of definitions do
not count: what cannot change a number does not change a fingerprint.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import hashlib
import itertools
import json
import os
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

from crackfront.core.private_cache import private_folder

ROOT = Path(__file__).parents[2]
"""Folder of the packages."""

_PACKAGES = ("crackfront", "studies")

_NO_PART = ("crackfront.data.fingerprint", "crackfront.core.private_cache")
"""Modules that decide what is stored where, and no number."""


def fingerprint(*names: str) -> str:
    """Twelve hexadecimal digits that change with the sources that some names reach.

    The names are modules, "crackfront.core.units", or definitions, "crackfront.core.jkr.force";
    ValueError if there is no such one. Of a class that is reached, the subclasses in modules that
    are reached count as well, of an abstract one all in its package. Files of data count byte by
    byte where they are named.

    Examples
    --------
    >>> fingerprint("crackfront.core.units") == fingerprint("crackfront.core.units.Scales")
    False
    """
    places = [place for package in _PACKAGES for place in _modules(package)]
    key = repr((names, str(ROOT), places, sys.version_info[:2])).encode()
    key += Path(__file__).read_bytes()
    # Without a folder of the user's own nothing is kept.
    kept = (private_folder("fingerprints") or Path(os.devnull)) / _digest(key)
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError, AttributeError):
        known = json.loads(kept.read_text("utf-8"))
        if known["files"] == _file_digests(known["files"]):
            return str(known["fingerprint"])
    reach = _Reach(names)
    found = reach.digest()[:12]
    with contextlib.suppress(OSError):
        part = kept.with_name(f"{kept.name}.{os.getpid()}")
        known = {"fingerprint": found, "files": _file_digests(reach.files)}
        part.write_text(json.dumps(known), "utf-8")
        part.replace(kept)
    return found


@functools.cache
def solver_fingerprint() -> str:
    """Twelve hexadecimal digits that change with what determines the fronts of a simulation."""
    parts = "cycle.run", "geometry.line", "solver.relax"
    return fingerprint(*(f"crackfront.core.{part}" for part in parts))


def _digest(content: bytes) -> str:
    """Hexadecimal digits of bytes."""
    return hashlib.sha256(content).hexdigest()


def _file_digests(places: Iterable[str]) -> dict[str, str]:
    """Hexadecimal digits of files, by their places below the folder of the packages."""
    return {place: _digest((ROOT / place).read_bytes()) for place in places}


def _modules(package: str) -> list[str]:
    """Places of all modules of a package, below the folder of the packages."""
    return sorted(str(path.relative_to(ROOT)) for path in (ROOT / package).rglob("*.py"))


class _Statement:
    """A statement at the top of a module: what it defines, what it uses, and what it means."""

    def __init__(self, node: ast.stmt, module: _Module) -> None:
        self.module, self._node = module, node
        targets = getattr(node, "targets", [getattr(node, "target", None)])
        found = (one for target in targets if target is not None for one in ast.walk(target))
        self.defined = [one.id for one in found if isinstance(one, ast.Name)]
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            self.defined.append(node.name)
        self.bases = [_dotted(base) or "" for base in getattr(node, "bases", ())]
        calls = (getattr(one, "func", None) for one in getattr(node, "decorator_list", ()))
        registers = any(_dotted(call) == "implements" for call in calls)
        self.is_class = isinstance(node, ast.ClassDef)
        self.acts = registers or not (self.defined or _is_mute(node))

    @functools.cached_property
    def uses(self) -> set[tuple[str, bool]]:
        """Names that it uses, with their attributes, and whether it does so in an annotation."""
        return set(_used(self._node, annotated=False))

    @functools.cached_property
    def data(self) -> set[Path]:
        """Files of data that it names, beside its module or in a package that it names."""
        values = [getattr(node, "value", None) for node in ast.walk(self._node)]
        texts = [value for value in values if isinstance(value, str)]
        homes = [ROOT / text.replace(".", "/") for text in texts if text.startswith(_PACKAGES)]
        names = [text for text in texts if text.endswith((".csv", ".json"))]
        paths = (home / name for home in (self.module.path.parent, *homes) for name in names)
        return {path for path in paths if path.is_file()}

    @functools.cached_property
    def meaning(self) -> list[str]:
        """Its text without what cannot change a number; every second part is a name."""
        return _text(self._node).split("\0")


class _Module:
    """The statements of a module by the names that they define, and what its imports bring."""

    def __init__(self, name: str, path: Path, content: bytes) -> None:
        self.name, self.path = name, path
        self.defined: dict[str, list[_Statement]] = defaultdict(list)
        self.imported: dict[str, set[str]] = defaultdict(set)
        tree = ast.parse(content)
        statements = [_Statement(node, self) for node in tree.body]
        self.acting = [one for one in statements if one.acts]
        for statement in statements:
            for defined in statement.defined:
                self.defined[defined].append(statement)
        for node in ast.walk(tree):
            home = f"{node.module}." if isinstance(node, ast.ImportFrom) else ""
            for alias in node.names if isinstance(node, (ast.Import, ast.ImportFrom)) else ():
                self.imported[alias.asname or alias.name].add(f"{home}{alias.name}")


_parsed = functools.cache(_Module)
"""The module of a name, parsed once for the same bytes."""


class _Reach:
    """The statements and files of data that some names reach."""

    def __init__(self, names: Iterable[str]) -> None:
        self._modules: dict[str, _Module | None] = {}
        self._counted: set[_Statement] = set()
        self._aliases: set[_Statement] = set()
        self._searched: dict[_Statement, set[_Module]] = {}
        self._waiting: list[tuple[_Statement, bool]] = []
        for name in names:
            origins = list(self._origins(name))
            if not origins:
                raise ValueError(f"there is no module or definition {name}; correct the name")
            for module, defined, _ in origins:
                for one in [defined] if defined else module.defined:
                    self._count(module.defined[one])
        while self._waiting:
            self._follow(*self._waiting.pop())
            if not self._waiting:
                self._count_subclasses()
        self._data = {path for one in self._counted for path in one.data}

    @property
    def files(self) -> list[str]:
        """Places of all files that were read, below the folder of the packages."""
        paths = {module.path for module in self._modules.values() if module is not None}
        return sorted(str(path.relative_to(ROOT)) for path in paths | self._data)

    def digest(self) -> str:
        """Hexadecimal digits of the meaning of all that is reached."""
        homes: dict[str, set[str]] = defaultdict(set)
        for statement in self._counted:
            for name in statement.defined:
                homes[name].add(statement.module.name)
        self._shared = {name for name in homes if len(homes[name]) > 1}
        parts = {self._text(statement).encode() for statement in self._counted}
        digests = sorted(map(_digest, [*parts, *(path.read_bytes() for path in self._data)]))
        return _digest("".join(digests).encode())

    def _module(self, name: str) -> _Module | None:
        """A module of the packages, if there is one of this full name."""
        if name not in self._modules:
            place = ROOT / name.replace(".", "/")
            paths = place.with_suffix(".py"), place / "__init__.py"
            path = None if name in _NO_PART else next(filter(Path.is_file, paths), None)
            self._modules[name] = None if path is None else _parsed(name, path, path.read_bytes())
        return self._modules[name]

    def _origins(self, name: str) -> Iterator[tuple[_Module, str, str]]:
        """Where a full name is defined: modules, its name there ("" for a module), attributes."""
        parts = name.split(".")
        for k in range(len(parts), 0, -1):
            if parts[0] in _PACKAGES and (module := self._module(".".join(parts[:k]))):
                rest = ".".join(parts[k:])
                yield from self._meant(module, rest) if rest else [(module, "", "")]
                return

    def _meant(self, module: _Module, name: str) -> Iterator[tuple[_Module, str, str]]:
        """Where what a name means in a module is defined, as of :meth:`_origins`."""
        first, dot, rest = name.partition(".")
        if first in module.defined:
            yield module, first, dot + rest
        for home in sorted(module.imported.get(first, ())):
            yield from self._origins(home + dot + rest)

    def _count(self, statements: Iterable[_Statement], *, annotated: bool = False) -> None:
        """Count statements; of what an annotation names classes count, not the aliases of types."""
        for statement in statements:
            is_alias = annotated and not statement.is_class
            known = self._aliases if is_alias else self._counted
            if statement not in known:
                known.add(statement)
                self._waiting.append((statement, is_alias))
                if not is_alias:
                    self._count(statement.module.acting)

    def _naming(self, abstract: _Statement) -> Iterator[_Module]:
        """Modules of the package of an abstract class that hold its name."""
        for place in _modules(abstract.module.name.partition(".")[0]):
            name = place.removesuffix(".py").replace("/", ".")
            named = abstract.defined[0].encode() in (ROOT / place).read_bytes()
            if named and (module := self._module(name)):
                yield module

    def _bases(self, statement: _Statement) -> set[_Statement]:
        """Classes of the packages that a class extends."""
        found = (one for base in statement.bases for one in self._meant(statement.module, base))
        return {home.defined[name][0] for home, name, _ in found if name}

    def _follow(self, statement: _Statement, is_alias: bool) -> None:
        """Count what a statement uses."""
        for used, annotated in statement.uses:
            for home, name, _ in self._meant(statement.module, used):
                if name:
                    self._count(home.defined[name], annotated=annotated or is_alias)

    def _count_subclasses(self) -> None:
        """Count the subclasses of what counts, of an abstract class wherever they are."""
        # Not while they are counted: the order of that is another in each process.
        while found := [
            one
            for one in self._counted - self._searched.keys()
            if "ABC" in one.bases or self._searched.keys() & self._bases(one)
        ]:
            self._searched |= {one: set(self._naming(one)) for one in found}
        searched = [(module, self._counted) for module in {one.module for one in self._counted}]
        for abstract, modules in self._searched.items():
            searched += [(module, {abstract}) for module in modules]
        for module, known in searched:
            for statement in itertools.chain(*module.defined.values()):
                if known & self._bases(statement):
                    self._count([statement])

    def _text(self, statement: _Statement) -> str:
        """Meaning of a statement, with modules before names that several of them define."""
        parts = list(statement.meaning)
        for k, used in enumerate(parts[1::2]):
            for home, name, rest in self._meant(statement.module, used):
                if name:
                    own = f"{home.name.rpartition('.')[2]}." if name in self._shared else ""
                    parts[2 * k + 1] = f"{own}{name}{rest}"
                    break
        return "".join(parts)


def _dotted(node: object) -> str:
    """A name with its attributes, such as `a.b.c`; "" for what is none."""
    if isinstance(node, ast.Attribute) and (before := _dotted(node.value)):
        return f"{before}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def _used(part: ast.AST, annotated: bool) -> Iterator[tuple[str, bool]]:
    """Names that a part of a syntax tree reads, and whether they stand in an annotation."""
    if (name := _dotted(part)) and isinstance(getattr(part, "ctx", None), ast.Load):
        yield name, annotated
    for field, value in ast.iter_fields(part):
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _used(child, annotated or field in ("annotation", "returns"))


def _text(part: object) -> str:
    """A part of a syntax tree without annotations and what does nothing, names between zeros."""
    if isinstance(part, list):
        return f"[{' '.join(_text(one) for one in part if not _is_mute(one))}]"
    if not isinstance(part, ast.AST):
        return repr(part)
    if name := _dotted(part):
        return f"\0{name}\0"
    if isinstance(part, ast.AnnAssign) and part.value is not None:
        part = ast.Assign([part.target], part.value)
    values = [
        f"\0{value}\0" if name == "name" else _text(value)
        for name, value in ast.iter_fields(part)
        if name not in ("annotation", "returns", "ctx", "kind", "type_comment")
    ]
    return f"({type(part).__name__} {' '.join(values)})"


def _is_mute(statement: object) -> bool:
    """Whether a statement is documentation, an import, or nothing that an import executes."""
    if isinstance(statement, ast.If):
        names = {node.id for node in ast.walk(statement.test) if isinstance(node, ast.Name)}
        return bool(names & {"TYPE_CHECKING", "__name__"})
    text = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    return text or isinstance(statement, (ast.Import, ast.ImportFrom))
