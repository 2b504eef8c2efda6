"""Files: written whole or not at all, with origin and checksums; read as written, or refused."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import secrets
import tempfile
import time
from collections.abc import Callable, Collection, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from crackfront.data.bounds import TooLargeError, refuse_beyond_memory
from crackfront.data.digests import (
    DAMAGED_SUFFIX,
    SUMS,
    digest_path,
    file_digest,
    forget_sums,
    read_sums,
    result_files,
    stated_digest,
    sums_text,
)
from crackfront.data.packs import PACK, File, checked, is_locked
from crackfront.data.provenance import Provenance, utc_now

PACKED: dict[str, Any] = {"zlib": True, "shuffle": True, "complevel": 1}
"""How arrays are compressed."""

_SECONDS_TO_WRITE = 3600.0
"""Time after which a file that is not finished will not be."""

NO_ROOM = (errno.ENOSPC, errno.EDQUOT)
"""Numbers of the errors of a full disk and of a used-up quota."""


class UnreadableFileError(ValueError):
    """A file that is missing, damaged, or not what its reader needs."""


class FileSystemError(OSError):
    """An operation that the file system does not allow; the message states the remedy."""


_LOCKING = "HDF5_USE_FILE_LOCKING"
"""Environment variable by which HDF5 opens files without a lock, as the command sets it."""


def refuse_failing_system(path: Path, error: Exception) -> None:
    """Raise an OSError if a file, which HDF5 refused, cannot be read or locked by the system."""
    with path.open("rb", buffering=0) as file:
        _refuse_without_locks(path, file.fileno(), error)
        while file.read(2**24):
            pass


def _refuse_without_locks(path: Path, number: int, error: Exception) -> None:
    """Raise if HDF5 could not lock an open file, with the path in the message."""
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
    _write(path, dataset, origin, sums=True)


def _write(path: Path, dataset: xr.Dataset, origin: Provenance, *, sums: bool) -> None:
    """Write a dataset as netCDF with its origin, atomically; checksums of arrays are a choice."""
    stamped = _stamped(dataset, origin)
    encoding = {str(name): _encoding(values, sums) for name, values in stamped.variables.items()}

    def write(part: Path) -> None:
        with utf8_path(part) as named:
            stamped.to_netcdf(named, engine="netcdf4", encoding=encoding)

    replace_atomically(path, write)


@contextlib.contextmanager
def utf8_path(path: Path) -> Iterator[Path]:
    """Path of a file for netCDF4, which reads UTF-8 alone, also in a folder of another encoding."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            yield Path(f"/proc/self/fd/{folder}", path.name)
        finally:
            os.close(folder)
    else:
        yield path


def dataset_content(dataset: xr.Dataset, origin: Provenance) -> bytes:
    """Content of a netCDF file of a dataset for a pack, which has a checksum of each of its files.

    Those of arrays would double the size of a curve.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "dataset.nc"
        _write(path, dataset, origin, sums=False)
        return path.read_bytes()


def _stamped(dataset: xr.Dataset, origin: Provenance) -> xr.Dataset:
    """A dataset with its origin."""
    date = utc_now()
    stamped = dataset.assign_attrs({"title": "results of crackfront"} | dataset.attrs)
    stamped.attrs |= {"Conventions": "CF-1.11", "history": f"{date}: {origin.command}"}
    stamped.attrs |= asdict(origin) | {"date": date}
    return stamped


def _encoding(values: xr.Variable, sums: bool) -> dict[str, Any]:
    """How a variable is stored: HDF5 has checksums for arrays of numbers or letters alone."""
    encoding: dict[str, Any] = {"fletcher32": True} if values.ndim and sums else {}
    if values.dtype.kind in "OU":
        return encoding | ({"dtype": "S1"} if values.ndim else {})
    if np.issubdtype(values.dtype, np.floating):
        encoding |= {"_FillValue": None} | (PACKED if values.ndim > 1 else {})
    return encoding


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically; names of files in the text stay the bytes that they are."""
    content = text.encode("utf-8", "surrogateescape")
    replace_atomically(path, lambda part: part.write_bytes(content))


def write_digest(path: Path) -> None:
    """Write the checksum of a file beside it, for readers to check before they open the file.

    The checksums of HDF5 leave the metadata of a file open: a flipped bit there may change what is
    read, and HDF5 does not return from some of them.
    """
    write_text(digest_path(path), sums_text({path.name: file_digest(path)}))


def replace_atomically(path: Path, write: Callable[[Path], Any]) -> None:
    """Let a function write a file beside the final one, and rename it once it is on disk.

    The folder of the final file is created. OSError if the place is none for a file, or the disk is
    full; what was there before stays.
    """
    refuse_no_file(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    # A name of its own: after a killed controller two writers of one file do happen.
    part = path.with_name(f".{path.stem}-{secrets.token_hex(8)}.part")
    try:
        write(part)
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        part.replace(path)
    except Exception as error:
        # What netCDF says of a full disk or of locks names anything but these.
        _refuse_failing_folder(path, error)
        raise
    finally:
        part.unlink(missing_ok=True)


def refuse_no_file(path: Path) -> None:
    """Raise an OSError if something stands at a path that is no ordinary file."""
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is a device or pipe, which is not replaced", str(path))


def _refuse_failing_folder(path: Path, error: Exception) -> None:
    """Raise if not a mebibyte can be written in the folder of a path, or no file locked there."""
    try:
        with tempfile.TemporaryFile(dir=path.parent) as probe:
            probe.write(bytes(2**20))
            probe.flush()
            os.fsync(probe.fileno())
            if not _is_of_system(error):
                _refuse_without_locks(path, probe.fileno(), error)
    except FileSystemError:
        raise
    except OSError as full:
        if full.errno in NO_ROOM:
            raise OSError(full.errno, os.strerror(full.errno), str(path)) from error


def _is_of_system(error: Exception) -> bool:
    """Whether an error has a number of the system; those of netCDF are negative."""
    return isinstance(error, OSError) and (error.errno or 0) > 0


def leftover_parts(folder: Path) -> Iterator[Path]:
    """Unfinished files of a folder that are older than an hour.

    Their age is the difference to the date of a new file, by the clock of the file system.
    """
    with tempfile.NamedTemporaryFile(prefix=".", suffix=".part", dir=folder) as new:
        now = Path(new.name).stat().st_mtime
        for path in folder.glob(".*.part"):
            with contextlib.suppress(FileNotFoundError):  # its writer has just renamed it
                if now - path.stat().st_mtime > _SECONDS_TO_WRITE:
                    yield path


def read_dataset(
    path: File, names: Collection[str] | None = None, *, copies: float = 1.0
) -> xr.Dataset:
    """Dataset of a netCDF file, or of one in a pack, in memory.

    Variables to read beside the coordinates are those of the names that are there; by default all.
    `copies` is the memory that is needed at once, relative to that of the variables. TooLargeError
    if they need more than there is, whatever the file holds of them; UnreadableFileError if there
    is no such file, it is damaged, or it is no complete netCDF file.
    """
    if isinstance(path, Path) and not path.is_file():
        what = "is no file" if path.exists() else "does not exist"
        raise UnreadableFileError(f"{path} {what}; check the name")
    source = path if isinstance(path, Path) else path.content()
    if source is None:
        raise UnreadableFileError(f"{path} {_DAMAGED}")
    try:
        opened = utf8_path(source) if isinstance(source, Path) else contextlib.nullcontext(source)
        with (
            opened as named,
            xr.open_dataset(named, engine="netcdf4", decode_times=False) as dataset,
        ):
            others = [] if names is None else [name for name in dataset if name not in names]
            chosen = dataset.drop_vars(others)
            refuse_beyond_memory(
                f"the variables of {path}", copies * chosen.nbytes, "use smaller ones"
            )
            return chosen.load()
    except (TooLargeError, MemoryError):
        raise
    except Exception as error:  # a damaged file may be wrong in any way
        if _is_of_system(error):
            raise
        if isinstance(source, Path):
            refuse_failing_system(source, error)
        raise UnreadableFileError(
            f"{path} is no complete netCDF file; write it again, or name another"
        ) from error


_DAMAGED = "is damaged, its checksum is wrong; restore it or write it again"


def is_damaged(path: Path, digest: str | None) -> bool:
    """Whether a file is not as it was written, by the checksum that a list or a file beside states.

    Without one, the arrays of a netCDF file are checked, which have their own, and the files in a
    pack; whatever else is there counts as whole.
    """
    known = stated_digest(path) if digest is None else digest
    if known is not None:
        return file_digest(path) != known
    if path.suffix == PACK:
        return checked(path)[1] > 0 and not is_locked(path)
    if path.suffix == ".nc":
        with contextlib.suppress(UnreadableFileError):
            read_dataset(path)
            return False
        return True
    return False


def damaged_files(folder: Path) -> list[Path]:
    """Files of a folder of results that are not as they were written."""
    listed = read_sums(folder)
    return [
        path
        for path in result_files(folder)
        if is_damaged(path, listed.get(str(path.relative_to(folder))))
    ]


def write_sums(folder: Path) -> Path:
    """Write the list of the checksums of a folder of results, and return its path.

    ValueError if a netCDF file or a pack is damaged, or the folder holds no result.
    """
    forget_sums(folder)
    if damaged := damaged_files(folder):
        raise ValueError(f"{damaged[0]} is damaged; run crackfront repair and make it again")
    digests = {str(path.relative_to(folder)): file_digest(path) for path in result_files(folder)}
    if not digests:
        raise ValueError(f"{folder} holds no file; name a folder of results")
    write_text(folder / SUMS, sums_text(digests))
    return folder / SUMS


def set_aside_damaged(folder: Path) -> Iterator[str]:
    """Rename the damaged files of a folder, but packs, to be made anew; a sentence each."""
    listed = read_sums(folder)
    damaged = damaged_files(folder)
    if damaged or any(not (folder / name).is_file() for name in listed):
        forget_sums(folder)
    for path in damaged:
        if path.suffix != PACK:
            yield f"{path} is damaged; it is made anew, and set aside as {set_aside(path).name}"


def reset_future_dates(folder: Path) -> None:
    """Give the files of a folder with a date in the future the date of now, except packs.

    Snakemake refuses inputs that are dated in the future.
    """
    now = time.time()
    for path in folder.rglob("[!.]*"):
        if path.is_file() and path.suffix != PACK and path.stat().st_mtime > now:
            os.utime(path, (now, now))


def set_aside(path: Path) -> Path:
    """Rename a file that is of no use, and return its new path."""
    return path.replace(path.with_name(path.name + DAMAGED_SUFFIX))


def read_attributes(path: Path) -> dict[str, Any]:
    """What a file says of itself; refused as by :func:`read_dataset`."""
    return {str(name): value for name, value in read_dataset(path, ()).attrs.items()}
