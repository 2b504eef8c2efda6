"""Standard output and error, on which no command depends once nobody reads them."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import stat
import sys
from collections.abc import Iterator
from typing import Any


@contextlib.contextmanager
def output_that_may_close() -> Iterator[None]:
    """Discard output once the reader of a pipe or a terminal is gone."""
    _open_standard_streams()
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (None if stream is None else _Output(stream) for stream in before)
    try:
        yield
    finally:
        for stream in filter(None, (sys.stdout, sys.stderr)):
            stream.flush()
        sys.stdout, sys.stderr = before


def _open_standard_streams() -> None:
    """Open streams that were closed before the start of the process on the null device.

    Otherwise a file that is opened later would get the number of such a stream, and its output.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number, which is this


class _Output:
    """A stream of text that discards its output once its reader is gone."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text and return its length, also if it is discarded."""
        try:
            self._stream.write(text)
        except OSError as error:
            self._discard_output(error)
        return len(text)

    def flush(self) -> None:
        """Write the text in the buffer."""
        try:
            self._stream.flush()
        except OSError as error:
            self._discard_output(error)

    def _discard_output(self, error: OSError) -> None:
        """Connect the stream to the null device if an error says that its reader is gone.

        This also discards text in its buffer and output of child processes. Any other error, such
        as a full disk, is raised.
        """
        try:
            number = self._stream.fileno()
        except io.UnsupportedOperation:  # a stream in memory, which lacks a reader
            raise error from None
        is_terminal = stat.S_ISCHR(os.fstat(number).st_mode)
        terminal_closed = error.errno == errno.EIO and is_terminal
        if not (isinstance(error, ConnectionError) or terminal_closed):
            raise error
        null_device = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null_device, number)
        os.close(null_device)
