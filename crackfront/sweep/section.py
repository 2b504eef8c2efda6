"""Strict YAML: sections of configurations, read from files, and sentences for their errors."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, ValidationInfo
from pydantic_core import ErrorDetails, PydanticCustomError
from ruamel.yaml import YAML
from ruamel.yaml.constructor import SafeConstructor
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.nodes import MappingNode, ScalarNode

from crackfront.core.arguments import nearest_name, regular_file
from crackfront.validation import PathName, sentence


def section_error(message: str) -> PydanticCustomError:
    """An error of a section with its own sentence."""
    return PydanticCustomError("section", "{message}", {"message": message})


_MOST_BYTES = 5e5
"""Largest size of a file; people write some thousands. (Units: byte)"""

_MOST_VALUES = 200_000
"""Largest number of values, including values of repeated anchors."""

_MOST_SENTENCES = 20
"""Errors of one file that are printed."""


def resolved_path(path: Path, info: ValidationInfo) -> Path:
    """Path that a configuration names; a relative one begins in the folder of the configuration."""
    return Path(info.context or "") / path


InputFile = Annotated[PathName, AfterValidator(resolved_path)]
"""A file that a configuration names; a relative path begins in the folder of the configuration."""

_HOME = "# Relative paths begin in "
"""First line of a configuration that is stored in another folder than it was in."""


def movable_text(path: Path) -> str:
    """Text of a configuration, its relative paths kept valid in whatever folder it is stored."""
    text = path.read_text(encoding="utf-8")
    if text.startswith(_HOME) or not re.search(r"\bfile\s*:", text):
        return text
    return f"{_HOME}{path.resolve().parent}\n{text}"


class ConfigurationError(ValueError):
    """A configuration that cannot be used; each line is a sentence on one fault."""


class Section(BaseModel):
    """A mapping of a file; unknown keys and conversions are not allowed."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Kind = TypeVar("Kind", bound=Section)


def validated(path: Path, content: object, schema: type[Kind]) -> Kind:
    """Section of a schema, filled with the content of a file that :func:`yaml_mapping` has read.

    ConfigurationError, with a sentence that names the file for each key that is unknown, missing
    or out of range.
    """
    try:
        return schema.model_validate(content, context=_home(path))
    except ValidationError as error:
        errors = _without_consequences(error.errors(include_url=False))
        lines = [f"{path}: {_sentence(item, schema)}" for item in errors[:_MOST_SENTENCES]]
        if len(errors) > _MOST_SENTENCES:
            lines.append(f"{path}: and {len(errors) - _MOST_SENTENCES} more such keys and values")
        raise ConfigurationError("\n".join(lines)) from error


def _home(path: Path) -> Path:
    """Folder in which the relative paths of a configuration begin."""
    with path.open(encoding="utf-8") as lines:
        first = lines.readline().rstrip("\n")
    return Path(first.removeprefix(_HOME)) if first.startswith(_HOME) else path.resolve().parent


def _without_consequences(errors: Sequence[ErrorDetails]) -> list[ErrorDetails]:
    """Errors without lists that pydantic calls too short only because their entries are wrong."""
    wrong_inside = {item["loc"][:depth] for item in errors for depth in range(len(item["loc"]))}
    return [
        item for item in errors if item["type"] != "too_short" or item["loc"] not in wrong_inside
    ]


class _Constructor(SafeConstructor):
    """Values of YAML 1.2, each key once; integers that are octal in YAML 1.1 are errors."""

    def construct_mapping(self, node: MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Mapping of a node, each key once."""
        if self.resolver.processing_version != (1, 2):
            raise MarkedYAMLError(problem="it is read as YAML 1.2; remove the line %YAML")
        names = set()
        for key, _ in node.value:
            name = str(self.construct_object(key, deep=True))
            if name in names:
                raise MarkedYAMLError(
                    problem=f"key {name!r} stands twice; remove one", problem_mark=key.start_mark
                )
            names.add(name)
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping

    def construct_yaml_int(self, node: ScalarNode) -> int:
        """Integer of a node, without a leading 0."""
        if re.fullmatch(r"[-+]?0[0-9_]+", node.value):
            raise MarkedYAMLError(
                problem=f"{node.value} begins with 0, as octal numbers do elsewhere; remove the 0",
                problem_mark=node.start_mark,
            )
        return int(super().construct_yaml_int(node))


_Constructor.add_constructor("tag:yaml.org,2002:int", _Constructor.construct_yaml_int)


def yaml_mapping(path: Path) -> dict[str, Any]:
    """Mapping in a YAML file, with tuples for lists.

    ConfigurationError if the file cannot be read, is not a mapping, or is larger or deeper than
    what a person writes.
    """
    content = _parsed(path, _text(path))
    if content is None:
        raise ConfigurationError(f"{path} is empty; write a configuration like config/test.yaml")
    if not isinstance(content, dict):
        kind = "a list" if isinstance(content, tuple) else "a single value"
        raise ConfigurationError(
            f"{path} contains {kind}, not keys with values; write a configuration like "
            "config/test.yaml"
        )
    return content


def _text(path: Path) -> str:
    """Text of a file; ConfigurationError if it cannot be read."""
    try:
        return regular_file(path, _MOST_BYTES).read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ConfigurationError(f"{path} is not a text in UTF-8; save it as UTF-8") from error
    except ValueError as error:
        raise ConfigurationError(str(error)) from error


def _parsed(path: Path, text: str) -> Any:
    """Value of a YAML text; ConfigurationError, with the path of its file, if it is not valid."""
    try:
        return _frozen(_loaded(text), count())
    except MarkedYAMLError as error:
        line = f" in line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise ConfigurationError(f"{path} is not valid YAML{line}: {error.problem}") from error
    except RecursionError as error:
        raise ConfigurationError(
            f"{path}: more than {_MOST_VALUES} values, or nested without end; write it shorter"
        ) from error
    except Exception as error:  # constructors raise various errors, as at impossible dates
        raise ConfigurationError(f"{path} is not valid YAML: {error}") from error


@functools.lru_cache(maxsize=8)
def _loaded(text: str) -> Any:
    """Value of a YAML text; commands ask several times for the same one."""
    reader = YAML(typ="safe", pure=True)
    reader.Constructor = _Constructor
    return reader.load(text)


def _frozen(value: Any, counted: Iterator[int]) -> Any:
    """A YAML value with tuples for lists and text for keys."""
    if next(counted) > _MOST_VALUES:
        raise RecursionError
    if isinstance(value, list):
        return tuple(_frozen(item, counted) for item in value)
    if isinstance(value, dict):
        return {str(key): _frozen(item, counted) for key, item in value.items()}
    return value


def _sentence(error: ErrorDetails, schema: type[Section]) -> str:
    """What one error of pydantic means."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in error["loc"])
    place = "".join(parts).lstrip(".")
    if error["type"] == "section":
        return f"{place}: {error['msg']}" if place else error["msg"]
    if error["type"] == "extra_forbidden":
        return f"unknown key {place}; {_nearest_key(error['loc'], schema)}"
    if error["type"] == "missing":
        return f"key {place} is missing; add it, as in config/default.yaml"
    key = next((part for part in reversed(error["loc"]) if isinstance(part, str)), "")
    if error["type"] == "float_type" and isinstance(error["input"], str):
        return f"{sentence(error, place)} without a unit; section scales is in m, J/m^2 and Pa"
    return f"{sentence(error, place)}{_MEANING.get(key, '')}"


_MEANING = {
    "elastic_energy": " (in units of w_int: full conformity needs an energy below w_int)",
    "work_of_adhesion_rms": " (in units of w_int: at 2 the energy of full conformity is w_int)",
}
"""What the bounds of a key are for."""


def _nearest_key(location: tuple[int | str, ...], schema: type[BaseModel]) -> str:
    """The nearest key that would be right at an unknown one."""
    section = schema
    for part in location[:-1]:
        if isinstance(part, str):
            section = _section_of(section.model_fields[part].annotation)
    return nearest_name(str(location[-1]), section.model_fields, "the keys here are")


def _section_of(annotation: Any) -> type[BaseModel]:
    """The section in the type of a field, as in `tuple[Section, ...]` or `Section | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(
        _section_of(part) for part in get_args(annotation) if part not in (Ellipsis, type(None))
    )
