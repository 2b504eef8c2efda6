"""Containers of contact.engineering: the measurements of surfaces, with what a person said of each.

A container is a ZIP file of data files, with `index.json` or `meta.yml` for units and sizes.
"""

from __future__ import annotations

import json
import math
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.constructor import SafeConstructor
from ruamel.yaml.error import YAMLError

from crackfront.core.resources import memory_at_hand
from crackfront.core.words import in_bytes
from crackfront.measured.scan.scan_files import LARGEST_FILE
from crackfront.surfaces.written_units import unit_value

InstrumentLength = Literal["tip_radius", "resolution"]
"""Parameters of instruments that limit the trusted waves."""

_METADATA = ("index.json", "meta.yml")
"""Files that list the content of a container; the first of them counts."""

_DATA = ("original", "squeezed-netcdf")
"""Data files of a measurement: as it was measured, and as contact.engineering has treated it."""

_LARGEST_METADATA = 16e6
"""Size of the metadata of some thousand measurements (Units: bytes)."""

_MOST_ENTRIES = 1000
"""Surfaces of a container, and measurements of a surface; anchors in YAML may repeat them."""

_ENCRYPTED = 0x1
"""Bit of an entry in a ZIP file whose content is encrypted."""


class _Entry(BaseModel):
    """A part of the metadata, of which more may be there than is used."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class ContainedMeasurement(_Entry):
    """A measurement in a container."""

    name: str = ""
    datafile: dict[str, str | None]
    size: tuple[float, ...] | None = None
    """Sides, in the unit."""
    unit: str | None = None
    """Unit of sides and heights."""
    height_scale: float = 1.0
    """What heights of the data file are multiplied by, to be in the unit."""
    data_source: int | None = None
    """Number of the channel."""
    is_periodic: bool = False
    instrument: Any = None
    """Name and kind of the instrument, and its parameters, of which :func:`stated_length` reads."""

    @property
    def is_original(self) -> bool:
        """Whether the data file is as it was measured, and needs the scale of its heights."""
        return bool(self.datafile.get(_DATA[0]))

    @property
    def scale(self) -> float:
        """What heights are multiplied by as they stand in the data file."""
        return self.height_scale if self.is_original else 1.0

    @property
    def file(self) -> str:
        """Name of the data file in the container."""
        return next((name for key in _DATA if (name := self.datafile.get(key))), "")

    @property
    def shown(self) -> str:
        """What the measurement is called."""
        return self.name or self.file


class ContainedSurface(_Entry):
    """A surface in a container, with its measurements."""

    name: str = ""
    topographies: tuple[ContainedMeasurement, ...] = Field(min_length=1, max_length=_MOST_ENTRIES)


class _Metadata(_Entry):
    """Content of a container, as it states it."""

    surfaces: tuple[ContainedSurface, ...] = Field(min_length=1, max_length=_MOST_ENTRIES)


class _Constructor(SafeConstructor):
    """Safe YAML with the tuples of Python, which contact.engineering writes."""


_Constructor.add_constructor(
    "tag:yaml.org,2002:python/tuple", lambda loader, node: loader.construct_sequence(node)
)


def contained_surfaces(path: Path) -> tuple[ContainedSurface, ...]:
    """Surfaces of a container; empty for any other file.

    ValueError, of one sentence, if it is encrypted or does not state its content.
    """
    if not zipfile.is_zipfile(path):
        return ()
    with _open(path) as archive:
        names = {member.filename for member in archive.infolist()}
        metadata = next((name for name in _METADATA if name in names), None)
        if metadata is None:
            return ()
        _check_size(path, archive, [metadata], _LARGEST_METADATA)
        text = _content(path, archive, metadata).decode("utf-8", "replace")
    try:
        if metadata.endswith(".json"):
            content: Any = json.loads(text)
        else:
            yaml = YAML(typ="safe", pure=True)
            yaml.Constructor = _Constructor
            content = yaml.load(text)
        return _Metadata.model_validate(content).surfaces
    except ValidationError as error:
        first, *_ = error.errors(include_url=False)
        place = ".".join(map(str, first["loc"])) or "the whole"
        raise ValueError(
            f"{path}: {metadata} does not state the content of the container: {place}: "
            f"{first['msg'].lower()}; download it again"
        ) from error
    except RecursionError as error:
        raise ValueError(
            f"{path}: {metadata} is nested too deeply to be the content of a container; download "
            "it again"
        ) from error
    except (YAMLError, ValueError) as error:
        raise ValueError(
            f"{path}: {metadata} is damaged ({str(error).splitlines()[0]}); download it again"
        ) from error


def chosen_surface(
    path: Path, surfaces: Sequence[ContainedSurface], requested: str | None
) -> ContainedSurface:
    """The surface of a name or number, or the only one of a container."""
    listed = "; ".join(
        f"{number} {surface.name!r} ({len(surface.topographies)} measurements)"
        for number, surface in enumerate(surfaces)
    )
    if requested is None and len(surfaces) > 1:
        raise ValueError(
            f"{path} contains {len(surfaces)} surfaces; choose one by number or name with "
            f"--surface: {listed}"
        )
    matches = [surface for surface in surfaces if requested is None or surface.name == requested]
    if not matches and requested is not None and requested.isdecimal():
        matches = list(surfaces[int(requested) : int(requested) + 1])
    if len(matches) != 1:
        many = "several surfaces" if matches else "no surface"
        raise ValueError(
            f"{path} has {many} {requested!r}; choose by number with --surface: {listed}"
        )
    return matches[0]


def stated_length(path: Path, member: ContainedMeasurement, name: InstrumentLength) -> float | None:
    """A length that a container states of an instrument, None where it states none (Units: m).

    ValueError, of one sentence that begins with the path, if its value is not a length.
    """
    entry = member.instrument
    for key in ("parameters", name):
        entry = entry.get(key) if isinstance(entry, dict) else None
    length = entry if isinstance(entry, dict) else {"value": entry}
    value, unit = length.get("value"), length.get("unit")
    if not value:
        return None
    try:
        metres = float(value) * unit_value(str(unit), "m")
    except (TypeError, ValueError):
        metres = math.nan
    if not 0 < metres < math.inf:
        raise ValueError(
            f"{path}: its container states the {name.replace('_', ' ')} of the instrument as "
            f"{value!r} in {unit!r}, which is not a length; correct it there, and download it again"
        )
    return metres


@contextmanager
def unpacked(path: Path, members: Sequence[ContainedMeasurement]) -> Iterator[list[Path]]:
    """Data files of measurements, in a folder that is removed afterwards."""
    with tempfile.TemporaryDirectory() as folder, _open(path) as archive:
        names = [member.file for member in members]
        _check_size(path, archive, names, LARGEST_FILE * memory_at_hand())
        files = []
        for number, member in enumerate(members):
            # A new name, as a name in the container may point anywhere.
            file = Path(folder, f"{number}{Path(member.file).suffix}")
            file.write_bytes(_content(path, archive, member.file))
            files.append(file)
        yield files


@contextmanager
def _open(path: Path) -> Iterator[zipfile.ZipFile]:
    """A ZIP file that is not encrypted."""
    try:
        with zipfile.ZipFile(path) as archive:
            if any(member.flag_bits & _ENCRYPTED for member in archive.infolist()):
                raise ValueError(
                    f"{path} is encrypted; unpack it with its password, and name the files in it"
                )
            yield archive
    except zipfile.BadZipFile as error:
        raise ValueError(f"{path} is a damaged ZIP file ({error}); download it again") from error


def _check_size(
    path: Path, archive: zipfile.ZipFile, names: Sequence[str], most_bytes: float
) -> None:
    """Raise if files that a container lists are missing, or larger than so many bytes together."""
    size = 0
    for name in names:
        try:
            size += archive.getinfo(name).file_size
        except KeyError as error:
            raise ValueError(f"{path} lacks {name!r}, which it lists; download it again") from error
    if size > most_bytes:
        shown = names[0] if len(names) == 1 else f"the {len(names)} files of its measurements"
        raise ValueError(
            f"{path}: {shown} would unpack to {in_bytes(size)}; more than {in_bytes(most_bytes)} "
            "are not read, so unpack it and name some of its files"
        )


def _content(path: Path, archive: zipfile.ZipFile, name: str) -> bytes:
    """Content of a file in a container; ValueError if it is damaged."""
    try:
        return archive.read(name)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
        raise ValueError(f"{path}: {name} is damaged ({error}); download it again") from error
