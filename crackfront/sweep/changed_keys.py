"""Keys of a configuration that changed since results were computed with it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from crackfront.sweep.section import ConfigurationError, yaml_mapping

_MOST_LISTED = 8
"""Changed keys that a sentence lists."""


def change_sentence(before: Path, now: Path) -> str:
    """Sentence on the keys in which two configurations differ; empty if none does.

    It is also empty if the earlier file is missing or not a configuration.
    """
    try:
        changes = [*_changes(yaml_mapping(before), yaml_mapping(now))]
    except ConfigurationError:
        return ""
    if not changes:
        return ""
    more = f", and {len(changes) - _MOST_LISTED} more" if len(changes) > _MOST_LISTED else ""
    return f"changed since the last run: {', '.join(changes[:_MOST_LISTED])}{more}"


def _changes(before: dict[str, Any], now: dict[str, Any]) -> Iterator[str]:
    """Each key that differs, with both values."""
    earlier, later = dict(_entries(before)), dict(_entries(now))
    for key in dict.fromkeys((*later, *earlier)):
        if key not in earlier:
            yield f"{key} is new, {_text(later[key])}"
        elif key not in later:
            yield f"{key} is removed, {_text(earlier[key])}"
        elif earlier[key] != later[key]:
            yield f"{key} from {_text(earlier[key])} to {_text(later[key])}"


def _entries(section: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Full names and values of all keys; the name of a spectrum is part of them."""
    for key, value in section.items():
        name = above + key
        if isinstance(value, dict):
            yield from _entries(value, f"{name}.")
        elif isinstance(value, tuple) and all(isinstance(item, dict) for item in value) and value:
            for item in value:
                yield from _entries(item, f"{name}.{item.get('name', '?')}.")
        else:
            yield name, value


def _text(value: Any) -> str:
    """Value as a configuration has it."""
    return str([*value]) if isinstance(value, tuple) else str(value)
