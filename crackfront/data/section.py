"""What sections of configurations have in common: strictness, and types of their values."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]
Energy = Annotated[float, Field(gt=0, lt=1, allow_inf_nan=False)]

InputFile = Annotated[Path, Field(strict=False)]
"""A file that a configuration names, from the folder in which the command runs."""


class Section(BaseModel):
    """A mapping of a file; unknown keys and conversions are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


def refusal(message: str) -> PydanticCustomError:
    """A refusal that keeps its own sentence."""
    return PydanticCustomError("section", "{message}", {"message": message})
