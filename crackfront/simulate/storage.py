"""Files: written whole or not at all, with origin and checksums, which reading checks.

xarray is imported only to read a dataset, because commands that write or check files without one
would wait for it.
"""

from __future__ import annotations

import errno
import fcntl
import os
import secrets
import tempfile
import time
from collections.abc import Callable, Collection, Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from crackfront.core.resources import TooLargeError, check_memory
from crackfront.simulate.checksums import (
    DAMAGED_SUFFIX,
    DIGITS_IN_NAME,
    digest_path,
    file_digest,
    is_whole,
    sums_text,
)
from crackfront.simulate.provenance import Provenance, utc_now

if TYPE_CHECKING:
    import xarray as xr

PACKED: dict[str, Any] = {"zlib": True, "shuffle": True, "complevel": 1}
"""How arrays are compressed."""

_WRITER_SECONDS = 0.2
"""Time in which a writer has replaced both a file and its checksum. (Units: s)"""

_LOCKING = "HDF5_USE_FILE_LOCKING"
"""Environment variable by which HDF5 opens files without a lock; the command line sets it."""

NO_ROOM = (errno.ENOSPC, errno.EDQUOT)
"""Numbers of the errors of a full disk and of a used-up quota."""


class UnreadableFileError(ValueError):
    """A file that is missing, damaged, or not what its reader needs."""


class FileSystemError(OSError):
    """An operation that the file system does not allow; the message states the remedy."""


def _check_readable(path: Path, error: Exception) -> None:
    """Raise an OSError if the system cannot read or lock a file that HDF5 did not open."""
    with path.open("rb", buffering=0) as file:
        _check_locks(path, file.fileno(), error)
        while file.read(2**24):
            pass


def _check_locks(path: Path, number: int, error: Exception) -> None:
    """Raise if HDF5 cannot lock the open file of this number, as if it were the one of the path."""
    if os.environ.get(_LOCKING, "").upper() in ("FALSE", "0"):
        return
    try:
        fcntl.flock(number, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        raise FileSystemError(
            f"{path} is locked by another process that writes it; wait until that has closed it"
        ) from error
    except OSError as failed:
        raise FileSystemError(
            f"{path} cannot be locked: {failed.strerror}; set {_LOCKING}=FALSE in the environment "
            "before the program starts"
        ) from error
    fcntl.flock(number, fcntl.LOCK_UN)


def write_dataset(path: Path, dataset: xr.Dataset, origin: Provenance) -> None:
    """Write a dataset as netCDF with its origin and checksums of its arrays, atomically.

    The folder is created.
    """
    replace_atomically(path, lambda part: _write_netcdf(part, dataset, origin))


def write_derived(path: Path, dataset: xr.Dataset, origin: Provenance) -> None:
    """Write a dataset as :func:`write_dataset`, and its checksum into `<path>.sha256`.

    HDF5 does not check the metadata of a file: a flipped bit there may change what is read, and
    from some damage it never returns. The checksum comes first, so that a new file never appears
    without it; after a kill in between, an earlier file counts as damaged and is derived again.
    """
    write_derived_parts(path, [dataset], origin)


def write_derived_parts(path: Path, parts: Iterable[xr.Dataset], origin: Provenance) -> None:
    """Write variables of several datasets into one file as :func:`write_derived`, each in turn.

    So only one of them needs to be in memory.
    """

    def write(part: Path) -> None:
        mode: Literal["w", "a"] = "w"
        for dataset in parts:
            _write_netcdf(part, dataset, origin, mode)
            mode = "a"

    def state_digest(part: Path) -> None:
        write_text(digest_path(path), sums_text({path.name: file_digest(part)}))

    replace_atomically(path, write, state_digest)


def write_named_by_digest(folder: Path, name: str, dataset: xr.Dataset, origin: Provenance) -> Path:
    """Write a dataset into `<name>-<digest>.nc`, named by its content; return the path.

    So the file and its checksum are renamed into place at once.
    """
    folder.mkdir(parents=True, exist_ok=True)
    unnamed = folder / f".{name}-{secrets.token_hex(8)}.nc"
    try:
        write_dataset(unnamed, dataset, origin)
        digest = file_digest(unnamed)[:DIGITS_IN_NAME]
        return unnamed.replace(folder / f"{name}-{digest}.nc")
    finally:
        unnamed.unlink(missing_ok=True)


def _write_netcdf(
    path: Path, dataset: xr.Dataset, origin: Provenance, mode: Literal["w", "a"] = "w"
) -> None:
    """Write a dataset as netCDF with its origin, or add it to a file."""
    stamped = _stamped(dataset, origin)
    encoding = {str(name): _encoding(values) for name, values in stamped.variables.items()}
    stamped.to_netcdf(path, mode, engine="netcdf4", encoding=encoding)


def _stamped(dataset: xr.Dataset, origin: Provenance) -> xr.Dataset:
    """A dataset with its origin."""
    date = utc_now()
    stamped = dataset.assign_attrs({"title": "results of crackfront"} | dataset.attrs)
    stamped.attrs |= {"Conventions": "CF-1.11", "history": f"{date}: {origin.command}"}
    stamped.attrs |= asdict(origin) | {"date": date}
    return stamped


def _encoding(values: xr.Variable) -> dict[str, Any]:
    """How a variable is stored: numbers with checksums; texts as strings, for which HDF5 has none.

    Arrays of characters would have checksums, but xarray cannot transpose them before they are
    loaded.
    """
    if values.dtype.kind in "OU":
        return {}
    encoding: dict[str, Any] = {"fletcher32": True} if values.ndim else {}
    if np.issubdtype(values.dtype, np.floating):
        encoding |= {"_FillValue": None} | (PACKED if values.ndim > 1 else {})
    return encoding


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically, in UTF-8."""
    replace_atomically(path, lambda part: part.write_text(text, encoding="utf-8"))


def replace_atomically(
    path: Path, write: Callable[[Path], Any], before_renaming: Callable[[Path], Any] | None = None
) -> None:
    """Let a function write a temporary file, and rename it to the final path once it is on disk.

    The folder of the final file is created. Another function may be called with the written file
    just before it is renamed. OSError if the path cannot be a file, or the disk is full; what was
    there before stays.
    """
    check_regular_file(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    # A name of its own: after a killed controller two writers of one file do happen.
    part = path.with_name(f".{path.stem}-{secrets.token_hex(8)}.part")
    try:
        write(part)
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        if before_renaming is not None:
            before_renaming(part)
        part.replace(path)
    except Exception as error:
        # netCDF names neither a full disk nor locks when these are the reason.
        _check_folder(path, error)
        raise
    finally:
        part.unlink(missing_ok=True)


def check_regular_file(path: Path) -> None:
    """Raise an OSError if a path exists and is not an ordinary file."""
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is a device or pipe, which is not replaced", str(path))


def _check_folder(path: Path, error: Exception) -> None:
    """Raise if not a mebibyte can be written in the folder of a path, or no file locked there."""
    try:
        with tempfile.TemporaryFile(dir=path.parent) as probe:
            probe.write(bytes(2**20))
            probe.flush()
            os.fsync(probe.fileno())
            if not _is_of_system(error):
                _check_locks(path, probe.fileno(), error)
    except FileSystemError:
        raise
    except OSError as full:
        if full.errno in NO_ROOM:
            raise OSError(full.errno, os.strerror(full.errno), str(path)) from error


def _is_of_system(error: Exception) -> bool:
    """Whether an error has a number of the system; numbers of netCDF are negative."""
    return isinstance(error, OSError) and (error.errno or 0) > 0


def read_dataset(
    path: Path, names: Collection[str] | None = None, *, copies: float = 1.0
) -> xr.Dataset:
    """Dataset of a netCDF file, in memory.

    `names` are the variables to read in addition to the coordinates, as far as the file has them;
    by default all. `copies` is the memory needed at once, relative to the size of the variables.
    TooLargeError if they need more than there is, even if the file stores them compressed;
    UnreadableFileError if the file is missing, damaged or not a complete netCDF file.
    """
    import xarray as xr

    if not path.is_file():
        problem = "is not a file" if path.exists() else "does not exist"
        raise UnreadableFileError(f"{path} {problem}; check the name")
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
            unused = [] if names is None else [name for name in dataset if name not in names]
            chosen = dataset.drop_vars(unused)
            check_memory(f"the variables of {path}", copies * chosen.nbytes, "use smaller ones")
            return chosen.load()
    except (TooLargeError, MemoryError):
        raise
    except Exception as error:  # a damaged file may be wrong in any way
        if _is_of_system(error):
            raise
        _check_readable(path, error)
        raise UnreadableFileError(
            f"{path} is not a complete netCDF file; write it again, or name another"
        ) from error


def set_aside_if_damaged(path: Path) -> str:
    """Rename a file that does not agree with its stated checksum; a sentence, or nothing if whole.

    The checksum is in the name of the file, or in `<path>.sha256`.
    """
    if is_whole(path):
        return ""
    time.sleep(_WRITER_SECONDS)
    if is_whole(path):
        return ""
    aside = set_aside(path)
    return f"{path} is damaged and was set aside as {aside.name}"


def set_aside(path: Path) -> Path:
    """Rename a file that is of no use, and return its new path."""
    return path.replace(path.with_name(path.name + DAMAGED_SUFFIX))


def read_derived(path: Path, names: Collection[str] | None = None) -> xr.Dataset:
    """Dataset of a file that :func:`write_derived` wrote, after a look at its checksum.

    UnreadableFileError if it is missing; if it is damaged, when it is set aside.
    """
    if not path.is_file():
        raise UnreadableFileError(f"{path} does not exist; run the workflow")
    if sentence := set_aside_if_damaged(path):
        raise UnreadableFileError(f"{sentence}; run the workflow, which makes it again")
    return read_dataset(path, names)


def read_attributes(path: Path) -> dict[str, Any]:
    """What a file says of itself; errors are as in :func:`read_dataset`."""
    return {str(name): value for name, value in read_dataset(path, ()).attrs.items()}
