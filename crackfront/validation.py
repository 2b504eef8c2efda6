"""Checks by pydantic of what enters the package, and the sentences for its errors.

Sections of configurations (`sweep/section.py`), options (`measured/options.py`) and arguments of
public functions (:func:`checked_call`) have the types of this module and its sentences. A validator
raises ValueError with a whole sentence, or :func:`expectation` with what follows "it must".
"""

from __future__ import annotations

import functools
import inspect
import operator
import re
import reprlib
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Annotated, Any, ParamSpec, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    validate_call,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from crackfront.core.bounds import COUNT, DENSITY, NUMBER, PLATEAU, SEED, SITES, Range

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")


def expectation(must: str) -> PydanticCustomError:
    """Error of a validator that is shown after the name and the value of what is wrong."""
    return PydanticCustomError("expectation", "{must}", {"must": must})


def within(bounds: Range, unit: str = "") -> AfterValidator:
    """Validator of numbers that must lie within bounds of a unit."""

    def checked(value: float) -> float:
        if not bounds.least <= value <= bounds.most:
            end = f" {unit}" if unit else ""
            raise expectation(f"it must lie between {bounds.least:g} and {bounds.most:g}{end}")
        return value

    return AfterValidator(checked)


def one_of(names: Collection[str]) -> AfterValidator:
    """Validator of texts that must be one of some names."""

    def checked(value: str) -> str:
        if value not in names:
            raise expectation(f"it must be one of {', '.join(sorted(names))}")
        return value

    return AfterValidator(checked)


def _whole_number(value: Any) -> Any:
    """An integer of any library as one of Python; anything else as it is."""
    try:
        return value if isinstance(value, bool) else operator.index(value)
    except TypeError:
        return value


WholeNumber = Annotated[int, BeforeValidator(_whole_number)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False), within(NUMBER)]
Plateau = Annotated[float, Field(gt=0, allow_inf_nan=False), within(PLATEAU)]
Density = Annotated[float, Field(gt=0, allow_inf_nan=False), within(DENSITY)]
Count = Annotated[WholeNumber, Field(ge=1), within(COUNT)]
Sites = Annotated[WholeNumber, within(SITES)]
Seed = Annotated[WholeNumber, Field(ge=0), within(SEED)]
Fraction = Annotated[float, Field(gt=0, lt=1), within(NUMBER)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
PathName = Annotated[Path, Field(strict=False)]
"""A path, or its text."""

_SHOWN = reprlib.Repr()
_SHOWN.maxlist, _SHOWN.maxstring, _SHOWN.maxother = 8, 80, 80
"""How a value is shown that may be long."""

_SHOWN_BY_VALUE = (str, int, float, bool, type(None), tuple, list, dict)
"""Types of which a sentence shows the value; of all others it names the type."""

_NOUNS = {
    "bool_type": "True or False",
    "callable_type": "a function",
    "finite_number": "finite",
    "float_type": "a number",
    "int_from_float": "a whole number",
    "int_type": "a whole number",
    "model_attributes_type": "a mapping of keys",
    "model_type": "a mapping of keys",
    "path_type": "the path of a file",
    "string_type": "a text",
    "tuple_type": "a list",
}
"""What a value must be, by the type of the error of pydantic."""


def shown_value(value: object) -> str:
    """The value in short, or its type if that says more.

    Examples
    --------
    >>> shown_value((1, 2)), shown_value("a"), shown_value(Path)
    ('[1, 2]', "'a'", 'a type')
    """
    if isinstance(value, _SHOWN_BY_VALUE):
        return _SHOWN.repr(list(value) if isinstance(value, tuple) else value)
    return f"a {_type_name(type(value))}"


def _type_name(kind: type[Any]) -> str:
    """Name of a type, with the library that it comes from."""
    library = kind.__module__.partition(".")[0]
    return kind.__qualname__ if library == "builtins" else f"{library}.{kind.__qualname__}"


def _expected(error: ErrorDetails) -> str:
    """What a value should have been, as the end of a sentence."""
    kind = error["type"]
    if kind == "string_pattern_mismatch":
        return "it must consist of letters, digits, _ and -"
    if kind == "too_short":
        least = error["ctx"]["min_length"]
        return f"it must have at least {'one entry' if least == 1 else f'{least} entries'}"
    if kind in _NOUNS or kind == "is_instance_of":
        return f"it must be {_noun(error)}"
    return re.sub(r"^(Input|String|Tuple|Value) should", "it must", error["msg"])


def _noun(error: ErrorDetails) -> str:
    """What a value of another type should have been."""
    if error["type"] == "is_instance_of":
        name = error["ctx"]["class"]
        return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"
    return _NOUNS[error["type"]]


def sentence(error: ErrorDetails, name: str) -> str:
    """What one error of pydantic means for the value of a name."""
    if error["type"] == "value_error":
        return str(error["ctx"]["error"])
    return f"{name} is {shown_value(error['input'])}; {_expected(error)}"


def checked_call(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Check the arguments of a public function by its annotations before it is called.

    The function then raises TypeError for arguments of another type and ValueError for other
    values, each with one sentence.

    Examples
    --------
    >>> @checked_call
    ... def half(number: Positive) -> float:
    ...     return number / 2
    >>> half("3")
    Traceback (most recent call last):
    TypeError: number is '3'; it must be a number
    """
    signature = inspect.signature(function)
    names = list(signature.parameters)
    checked = validate_call(config=_ARGUMENTS)(function)

    @functools.wraps(function)
    def call(*arguments: Parameters.args, **keywords: Parameters.kwargs) -> Result:
        signature.bind(*arguments, **keywords)
        try:
            return checked(*arguments, **keywords)
        except ValidationError as error:
            raise _argument_error(error.errors(include_url=False), names) from None

    return call


_ARGUMENTS = ConfigDict(strict=True, arbitrary_types_allowed=True, defer_build=True)
"""Nothing is converted; pydantic reads the annotations at the first call."""


def _argument_error(errors: Sequence[ErrorDetails], names: Sequence[str]) -> Exception:
    """TypeError or ValueError about the first argument that cannot be used.

    An argument that may have several types has an error for each.
    """
    place = errors[0]["loc"][0]
    errors = [error for error in errors if error["loc"][0] == place]
    name = names[place] if isinstance(place, int) else str(place)
    values = [error for error in errors if not _is_of_type(error)]
    if values:
        return ValueError(sentence(values[0], name))
    nouns = " or ".join(dict.fromkeys(map(_noun, errors)))
    return TypeError(f"{name} is {shown_value(errors[0]['input'])}; it must be {nouns}")


def _is_of_type(error: ErrorDetails) -> bool:
    """Whether an error is about the type of a value."""
    return error["type"].endswith("_type") or error["type"] == "is_instance_of"
