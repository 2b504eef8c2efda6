"""The notice that this process is to end: SIGTERM, or a file.

A batch system sends SIGTERM some time before it kills. Launchers differ in whether they pass it on
to their ranks or kill them, so that whoever started a launcher leaves the ranks a file instead.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

VARIABLE = "CRACKFRONT_NOTICE"
"""Environment variable that names the file."""

_received = threading.Event()


class NoticeGivenError(Exception):
    """Work was left because of the notice; what was reached is stored."""


def is_given() -> bool:
    """Whether this process is to end."""
    name = os.environ.get(VARIABLE)
    return _received.is_set() or (name is not None and Path(name).exists())


@contextlib.contextmanager
def heeded() -> Iterator[None]:
    """Take SIGTERM as the notice, and not as the end, of this process."""

    def receive(number: int, frame: FrameType | None) -> None:
        _received.set()

    before = signal.signal(signal.SIGTERM, receive)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
        _received.clear()
