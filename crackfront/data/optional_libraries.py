"""Optional libraries: the error of one that is needed and not installed."""

from __future__ import annotations


class MissingExtraError(ValueError):
    """An optional library that is needed and not installed.

    Parameters
    ----------
    purpose : str
        What needs it, with a plural verb's subject: "boundary elements".
    error : ModuleNotFoundError
        What the import said.
    extra : str
        Name of the extra of this package that brings it.
    """

    def __init__(self, purpose: str, error: ModuleNotFoundError, extra: str) -> None:
        name = (error.name or "a library").partition(".")[0]
        super().__init__(
            f"{purpose} need {name}, which is not installed; in the folder of the source of "
            f"crackfront, install it with: pip install '.[{extra}]'"
        )
