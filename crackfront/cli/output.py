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
    """Discard output once the reader of a pipe or a terminal is gone.

    A stream that was closed before the start is opened on the null device, as a file that is opened
    later would otherwise get its number and the output.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number, which is this
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (None if stream is None else _Output(stream) for stream in before)
    try:
        yield
    finally:
        for stream in filter(None, (sys.stdout, sys.stderr)):
            stream.flush()
        sys.stdout, sys.stderr = before


class _Output:
    """A stream of text whose reader may go."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text; its length, as if all of it were written."""
        try:
            self._stream.write(text)
        except OSError as error:
            self._leave(error)
        return len(text)

    def flush(self) -> None:
        """Hand on what is written."""
        try:
            self._stream.flush()
        except OSError as error:
            self._leave(error)

    def _leave(self, error: OSError) -> None:
        """Have the rest go nowhere, what waits in the stream and what other processes write too.

        The error is raised where it is not that the reader is gone, as of a full disk.
        """
        with contextlib.suppress(io.UnsupportedOperation):
            number = self._stream.fileno()
            hung_up = error.errno == errno.EIO and stat.S_ISCHR(os.fstat(number).st_mode)
            if isinstance(error, ConnectionError) or hung_up:
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, number)
                os.close(nowhere)
                return
        raise error
