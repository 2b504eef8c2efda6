"""Configurations of the validation by boundary elements."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from crackfront.data.yaml import ConfigurationError, content_of, sentences
from crackfront.studies.boundary_elements.parameters import ValidationParameters


def load_validation(path: Path) -> ValidationParameters:
    """Parameters of a validation.

    Parameters
    ----------
    path : Path
        YAML file like config/validation.yaml.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, or anything in it is unknown, missing or out of range; one
        sentence for each.
    """
    try:
        return ValidationParameters.model_validate(content_of(path))
    except ValidationError as error:
        raise ConfigurationError(
            "\n".join(f"{path}: {line}" for line in sentences(error.errors(), ValidationParameters))
        ) from error
