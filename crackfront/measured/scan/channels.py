"""Channels of a file: what they are of, and which one is read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crackfront.measured.scan.library import errors_as_sentences

_NO_HEIGHTS = re.compile(
    "ampl|phase|error|deflection|friction|potential|adhesion|intensity", re.IGNORECASE
)
"""Names of channels that are not of heights, also where the file gives them a unit of length."""

_HEIGHTS = re.compile(
    r"height|topograph|elevation|surface|(?:^|[^a-z])z(?:$|[^a-z]|sensor)", re.IGNORECASE
)
"""Names of arrays that are of heights."""

_BARE_ARRAYS = {"h5", "mat", "npz", "nc"}
"""Formats whose arrays state their quantity by their names alone."""

_OTHER_OBJECTS = {
    3: "a picture of two levels",
    10: "intensities",
    12: "a picture in colour",
    14: "a force curve",
    15: "force curves",
    20: "a spectrum",
}
"""What SUR files contain in place of heights, by the number of the type in their head."""


@dataclass(frozen=True, slots=True)
class Channel:
    """What a file says of one of its channels."""

    number: int
    name: str
    quantity: str
    """Such as height or phase."""
    points: tuple[int, ...]
    is_default: bool
    """Whether it is read where none is named."""

    def __str__(self) -> str:
        """A line on it."""
        warned = self.quantity == "height" and is_doubtful(self.name)
        quantity = f"{self.quantity}{', by its name another quantity' if warned else ''}"
        points = f", {' x '.join(map(str, self.points))} points" if self.points else ""
        default = ", default" if self.is_default else ""
        return f"{self.number} {self.name!r} ({quantity}){points}{default}"


def channels_of(path: Path, reader: Any) -> tuple[Channel, ...]:
    """Channels of a file, numbered as its reader has them."""
    with errors_as_sentences(path):
        default = _default(reader)
        return tuple(
            Channel(
                channel.index,
                channel.name,
                _kind(channel),
                channel.nb_grid_pts or (),
                channel.index == default,
            )
            for channel in reader.channels
        )


def _default(reader: Any) -> int | None:
    """Number of the channel that is read where none is named; None where nothing says which."""
    channels = reader.channels
    if reader.format() not in _BARE_ARRAYS or len(channels) < 2:
        return int(reader.default_channel.index) if channels else None
    lengths = [channel for channel in channels if _kind(channel) == "height"]
    likely = [
        channel
        for channel in lengths
        if _HEIGHTS.search(channel.name) and not is_doubtful(channel.name)
    ]
    height_channels = likely or (lengths if reader.format() == "nc" else [])
    return int(height_channels[0].index) if len(height_channels) == 1 else None


def chosen_channel(path: Path, reader: Any, requested: str | None) -> tuple[Any, str]:
    """A channel of heights, the library's own choice if none is named, and what it is called."""
    channels = channels_of(path, reader)
    if not channels and _is_tiff(path):
        raise ValueError(
            f"{path} is a picture in TIFF, which states no unit of its heights; export it from the "
            "instrument again, as X3P if there is a choice, or the heights as text"
        )
    if not channels:
        raise ValueError(
            f"{path}, read as {reader.format()}, lacks an array of numbers in two dimensions that "
            "may have heights; export the heights as one, not intensities or a picture alone"
        )
    description = _requested(path, channels, requested)
    if description.quantity != "height":
        height_channels = [channel for channel in channels if channel.quantity == "height"]
        raise ValueError(
            f"{path}: channel {description.name!r} contains {description.quantity}, not heights; "
            + (_choice(height_channels) if height_channels else "export the channel of the heights")
        )
    several = f", {description.number} of {len(channels)}" if len(channels) > 1 else ""
    [channel] = [channel for channel in reader.channels if channel.index == description.number]
    n_object = _stated_by_sur(channel, "nb_objects")
    n_heights = sum(channel.quantity == "height" for channel in channels)
    if n_heights > 1 and reader.format() not in _BARE_ARRAYS:
        several += f" ({n_heights} of heights; --channel chooses)"
    if n_object > 1:
        several += f", the first of {n_object} objects in the file"
    return channel, f"{description.name!r}{several}"


def _requested(path: Path, channels: Sequence[Channel], requested: str | None) -> Channel:
    """The channel of a name or number, or the one that is read where none is named."""
    if requested is None:
        default = next((channel for channel in channels if channel.is_default), None)
        if default is None:
            raise ValueError(
                f"{path} contains {len(channels)} arrays, and their names do not say which one has "
                f"the heights; {_choice(channels)}"
            )
        return default
    matches = [channel for channel in channels if channel.name == requested]
    matches = matches or [channel for channel in channels if str(channel.number) == requested]
    if len(matches) != 1:
        raise ValueError(
            f"{path} has {'several channels' if matches else 'no channel'} {requested!r}; "
            f"{_choice(channels)}"
        )
    return matches[0]


def _is_tiff(path: Path) -> bool:
    """Whether a file begins as a picture in TIFF."""
    with path.open("rb") as file:
        return file.read(4) in (b"II*\0", b"MM\0*")


def _kind(channel: Any) -> str:
    """Quantity of a channel: height, phase and others."""
    object_name = _OTHER_OBJECTS.get(_stated_by_sur(channel, "type"))
    if object_name is not None:
        return object_name
    # A reader takes any quantity over lengths for heights, and has two units for it.
    return "another quantity" if isinstance(channel.unit, tuple) else str(channel.data_kind.value)


def _stated_by_sur(channel: Any, name: str) -> int:
    """Number in the head of a SUR file, 0 in other formats."""
    head = channel.info.get("raw_metadata")
    is_sur = isinstance(head, dict) and head.get("magic") == "DIGITAL SURF"
    return int(head[name]) if is_sur else 0


def is_doubtful(channel: str) -> bool:
    """Whether the name of a channel says that it does not contain heights."""
    return _NO_HEIGHTS.search(channel) is not None


def _choice(channels: Sequence[Channel]) -> str:
    """Sentence that lists channels."""
    return f"choose by number or name with --channel: {'; '.join(map(str, channels))}"
