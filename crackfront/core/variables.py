"""Names, units and dimensions of the fields of records, as files state them."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any

from crackfront.core.units import ReducedUnit

LATERAL = ReducedUnit.LATERAL
VERTICAL = ReducedUnit.VERTICAL
FORCE = ReducedUnit.FORCE
ADHESION = ReducedUnit.ADHESION
ENERGY = ReducedUnit.ENERGY
AREA = ReducedUnit.AREA

LENGTH = "length, in the unit of the tile"
"""Unit of lengths of straight fronts on a tile that no sphere scales."""

STEP = "step"
"""Dimension of the states of a cycle."""

_KEY = "variable"


@dataclass(frozen=True, slots=True)
class Variable:
    """Name, dimensions, units and long name of one variable of a file."""

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of the variable in a file."""
        return {"units": str(self.units), "long_name": self.long_name}


def variable(long_name: str, units: str, *dims: str, default: Any = MISSING) -> Any:
    """A field of a dataclass that files store as a variable of these dimensions.

    Without dimensions it is a number, a truth value or a text. A field whose default is None is
    left out of files where it is None.
    """
    return field(default=default, metadata={_KEY: (dims, units, long_name)})


def variables(kind: type[Any], *along: str) -> tuple[Variable, ...]:
    """Variables in which a file stores the fields of a dataclass that :func:`variable` made.

    Dimensions that count several records, given as `along`, precede the dimensions of each field.

    Examples
    --------
    >>> @dataclass
    ... class Curve:
    ...     force: float = variable("normal force", "N")
    >>> variables(Curve)
    (Variable(name='force', dims=(), units='N', long_name='normal force'),)
    """
    stored = (item for item in fields(kind) if _KEY in item.metadata)
    listed = (Variable(item.name, *item.metadata[_KEY]) for item in stored)
    return tuple(replace(item, dims=(*along, *item.dims)) for item in listed)
