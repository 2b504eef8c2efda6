"""Optional libraries: the error of one that is needed and not installed."""

from __future__ import annotations


class MissingExtraError(ValueError):
    """An optional library that is needed and not installed.

    The purpose is what needs it, the subject of a plural verb: "boundary elements". The error is
    what the import said. The extra of this package brings the library.
    """

    def __init__(self, purpose: str, error: ModuleNotFoundError, extra: str) -> None:
        name = (error.name or "a library").partition(".")[0]
        super().__init__(
            f"{purpose} need {name}, which is not installed; in the folder of the source of "
            f"crackfront, install it with: pip install '.[{extra}]'"
        )
