"""Values for JSON in place of records, arrays, paths, and numbers that are not finite."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any


def to_jsonable(value: Any) -> Any:
    """A value for JSON: records and arrays by their entries, null for what is not finite."""
    if hasattr(value, "tolist"):  # of numpy, a number too
        return to_jsonable(value.tolist())
    if is_dataclass(value):
        return {item.name: to_jsonable(getattr(value, item.name)) for item in fields(value)}
    if isinstance(value, Mapping):
        return {name: to_jsonable(one) for name, one in value.items()}
    if isinstance(value, (tuple, list)):
        return [to_jsonable(one) for one in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value) if isinstance(value, Path) else value
