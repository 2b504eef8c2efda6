"""Checks of the files that a command will write, before anything is computed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path


def check_writable(folder: Path) -> None:
    """Raise an OSError where a folder cannot be made or written to, before anything is computed."""
    import tempfile

    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        # The name of the temporary file says nothing to a user.
        raise OSError(error.errno, error.strerror, str(folder)) from error


def check_overwriting(inputs: Iterable[Path], outputs: Mapping[str, Path | None]) -> None:
    """Raise ValueError if an output is a file that the command reads, or two outputs are one.

    `outputs` are the files that options name; a figure without suffix is a PDF and a PNG.
    """
    # `Path.resolve` raises an error for a link to itself.
    read = {os.path.realpath(path) for path in inputs}
    written: dict[str, str] = {}
    for option, output in outputs.items():
        if output is None:
            continue
        is_stem = option == "--figure" and not output.suffix
        for path in [Path(f"{output}{end}") for end in (".pdf", ".png")] if is_stem else [output]:
            place = os.path.realpath(path)
            if place in read:
                raise ValueError(
                    f"{option} would overwrite {path}, which the command reads; name another file"
                )
            if place in written:
                raise ValueError(
                    f"{written[place]} and {option} are the same file, {path}; name two files"
                )
            written[place] = option


def check_replaced_table(option: str, path: Path | None, first: str) -> None:
    """Raise ValueError if a file exists that is not a table with this first column."""
    _check_beginning(option, path, first)


def check_replaced_page(option: str, path: Path | None) -> None:
    """Raise ValueError if a file exists that is not a page of HTML as crackfront writes it."""
    _check_beginning(option, path, "<!doctype html>")


def _check_beginning(option: str, path: Path | None, text: str) -> None:
    """Raise ValueError if a file exists that does not begin with a text."""
    if path is None or not path.is_file():
        return
    with path.open("rb") as file:
        if file.read(len(text)) != text.encode():
            raise _foreign(option, path)


def check_replaced_netcdf(option: str, path: Path | None) -> None:
    """Raise ValueError if a file exists that is not a netCDF file of crackfront."""
    from crackfront.simulate.storage import UnreadableFileError, read_attributes

    if path is None or not path.is_file():
        return
    try:
        attributes = read_attributes(path)
    except UnreadableFileError:
        attributes = {}
    if "crackfront_version" not in attributes:
        raise _foreign(option, path)


def _foreign(option: str, path: Path) -> ValueError:
    """Error of an option that names a file which crackfront has not written."""
    return ValueError(
        f"{option} is {path}, a file that exists and that crackfront has not written; name another"
    )
