"""Values for JSON instead of records, arrays and paths."""

from __future__ import annotations

from typing import Any

from pydantic_core import to_jsonable_python


def to_jsonable(value: Any) -> Any:
    """A value for JSON: records and arrays by their entries, null for NaN and infinities."""
    return to_jsonable_python(value, inf_nan_mode="null", fallback=lambda array: array.tolist())
