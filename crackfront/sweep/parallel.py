"""Tasks over MPI ranks, or one after the other without MPI, until a stop is requested.

This is the only importer of mpi4py. Rank 0 hands tasks to the others by `mpi4py.futures`. A stop is
requested by SIGTERM, which a batch system sends some time before it kills, by Ctrl-C or by closing
the terminal.
"""

from __future__ import annotations

import contextlib
import os
import queue
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from types import FrameType
from typing import Any, TypeVar, cast

Task = TypeVar("Task")
Result = TypeVar("Result")
Kept = TypeVar("Kept")

_COUNT_VARIABLES = (
    *("PMI_SIZE", "MPI_LOCALNRANKS", "OMPI_COMM_WORLD_SIZE", "MV2_COMM_WORLD_SIZE"),
    *("SLURM_STEP_NUM_TASKS", "JSM_NAMESPACE_SIZE", "FLUX_JOB_SIZE"),
)
"""Environment variables in which launchers state how many processes they start.

SLURM_NTASKS is not among them: a batch script, which is one process, sees the tasks of its job.
"""

_SECONDS = 0.1
"""Longest time between two looks at signals and at what is to be written. (Units: s)"""

_SHARED_MEMORY = "/dev/shm"
"""Folder in which MPI exchanges messages within a machine; too little room is a bus error."""

_SHARED_BYTES = 6e6
"""What MPICH takes there for each rank. (Units: byte)"""

_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Signals that request a stop; one that was ignored at the start of the process stays ignored."""

_received = threading.Event()


def stop_is_requested() -> bool:
    """Whether this process is to store what it has and end."""
    return _received.is_set()


@contextlib.contextmanager
def deferring_stops() -> Iterator[None]:
    """Let signals only set :func:`stop_is_requested`; a second Ctrl-C ends the process at once.

    Ranks get a signal twice, from the terminal and from their launcher: the second is ignored.
    """

    def receive(number: int, frame: FrameType | None) -> None:
        if number == signal.SIGINT and _received.is_set() and not is_launched():
            raise KeyboardInterrupt
        if not (_received.is_set() or is_launched()):
            _announce_stop()
        _received.set()

    try:
        with _handling_stops(receive):
            yield
    finally:
        _received.clear()


def _announce_stop() -> None:
    """Print, within the handler of a signal, that the process ends at the next load step."""
    with contextlib.suppress(OSError):  # of a terminal that was closed
        os.write(2, b"Stopping at the next load step of what runs; Ctrl-C again ends it at once\n")


def stopping_as_ctrl_c() -> contextlib.AbstractContextManager[None]:
    """Raise KeyboardInterrupt at every signal that requests a stop, as Ctrl-C does."""
    return _handling_stops(signal.default_int_handler)


@contextlib.contextmanager
def _handling_stops(receive: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Handle each signal that requests a stop by a function of its number."""
    # Only the main thread receives signals and may set their handlers.
    in_main = threading.current_thread() is threading.main_thread()
    heeded = [number for number in _SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, receive) for number in heeded if in_main}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def is_launched() -> bool:
    """Whether a launcher says that it has started several processes of this command."""
    # A shell on the first of several tasks of Slurm has their variables, and is alone.
    return "SLURM_PTY_PORT" not in os.environ and max(map(_number_in, _COUNT_VARIABLES)) > 1


def _number_in(variable: str) -> int:
    """Whole number in an environment variable; 0 where there is none."""
    text = os.environ.get(variable, "").strip()
    return int(text) if text.isdecimal() else 0


@contextlib.contextmanager
def ranks() -> Iterator[Ranks | None]:
    """The ranks that simulate, on the manager; None on the others, after they have served it.

    Without a launcher this process is the only one. ValueError if a launcher of another MPI library
    has started several processes, each of which sees itself alone.
    """
    if not is_launched():
        yield ALONE
        return
    _check_shared_memory()
    from mpi4py import MPI
    from mpi4py.futures import MPICommExecutor

    world = MPI.COMM_WORLD
    if world.size == 1:
        library = MPI.Get_library_version().splitlines()[0].strip()
        raise ValueError(
            "a launcher started several processes of this command, but the MPI library of mpi4py, "
            f"{library}, sees one each; use the launcher of this library, or install mpi4py for "
            "the library of the launcher (make env MPI=system)"
        )

    def abort(kind: type[BaseException], error: BaseException, where: Any) -> None:
        # Ranks wait for each other for ever where one of them fails outside of a task.
        traceback.print_exception(kind, error, where)
        world.Abort(1)

    sys.excepthook = abort
    n_here = world.Split_type(MPI.COMM_TYPE_SHARED).size
    with MPICommExecutor(world, root=0) as executor:
        # On the manager it is an executor, whatever the stubs of mpi4py say.
        pool = cast("Executor | None", executor)
        yield None if pool is None else Ranks(pool, max(1, n_here - 1))


def _check_shared_memory() -> None:
    """Raise ValueError if MPI has too little memory for messages, as in small containers."""
    with contextlib.suppress(OSError):
        size = shutil.disk_usage(_SHARED_MEMORY).total
        n_here = max(2, _number_in("MPI_LOCALNRANKS"))
        if size < n_here * _SHARED_BYTES:
            raise ValueError(
                f"{_SHARED_MEMORY} has {size / 1e6:.2g} MB, and MPI needs {_SHARED_BYTES / 1e6:g} "
                f"MB for each of {n_here} ranks; give the container more, as by --shm-size=1g, or "
                "run one process"
            )


def nothing() -> None:
    """Do nothing."""


@dataclass(frozen=True, slots=True)
class Ranks:
    """Ranks that run tasks, or this process alone."""

    executor: Executor | None
    n_here: int
    """Ranks that simulate on this machine."""

    def run(
        self,
        function: Callable[[Task, Callable[[], None]], Result],
        tasks: Sequence[Task],
        keep: Callable[[Task, Result], Kept],
        idle: Callable[[], None] = nothing,
    ) -> Generator[tuple[Task, Kept]]:
        """Tasks with what is kept of them, as they end; a free rank starts the next of the list.

        The function is a module's; it and the tasks travel by pickle. It takes a task, and `idle`,
        which it calls from time to time where it runs in this process; else this process calls it
        while it waits. `keep` takes every task and its result here, also of those that end while
        this is closed. No task begins after a stop was requested. An exception of a task is raised
        here, when the tasks that run at the same time have ended.
        """
        if self.executor is None:
            return _run_here(function, tasks, keep, idle)
        return _run_on_ranks(self.executor, function, tasks, keep, idle)


def _run_here(
    function: Callable[[Task, Callable[[], None]], Result],
    tasks: Sequence[Task],
    keep: Callable[[Task, Result], Kept],
    idle: Callable[[], None],
) -> Generator[tuple[Task, Kept]]:
    """Run tasks one after the other in this process, as :meth:`Ranks.run`."""
    for task in tasks:
        if stop_is_requested():
            return
        yield task, keep(task, function(task, idle))


def _run_on_ranks(
    executor: Executor,
    function: Callable[[Task, Callable[[], None]], Result],
    tasks: Sequence[Task],
    keep: Callable[[Task, Result], Kept],
    idle: Callable[[], None],
) -> Generator[tuple[Task, Kept]]:
    """Run tasks on other ranks, as :meth:`Ranks.run`."""
    running = {executor.submit(function, task, nothing): task for task in tasks}
    # A queue finds the next that has ended without a look at all of them.
    ended: queue.SimpleQueue[Future[Result]] = queue.SimpleQueue()
    for future in running:
        future.add_done_callback(ended.put)
    try:
        while running and not stop_is_requested():
            idle()
            if next_ended := _next_ended(ended):
                task = running.pop(next_ended)
                yield task, keep(task, next_ended.result())
    finally:
        _keep_last_results(running, ended, keep, idle)


def _next_ended(ended: queue.SimpleQueue[Future[Result]]) -> Future[Result] | None:
    """The next task that has ended; None if a moment passes without one."""
    try:
        return ended.get(timeout=_SECONDS)
    except queue.Empty:
        return None


def _keep_last_results(
    running: dict[Future[Result], Task],
    ended: queue.SimpleQueue[Future[Result]],
    keep: Callable[[Task, Result], Kept],
    idle: Callable[[], None],
) -> None:
    """Wait for tasks that have begun, and keep their results; cancel the others."""
    for future in running:
        future.cancel()
    while running:
        # If results cannot be written now, they are kept with those to come.
        with contextlib.suppress(OSError):
            idle()
        if next_ended := _next_ended(ended):
            task = running.pop(next_ended)
            if not next_ended.cancelled() and next_ended.exception() is None:
                keep(task, next_ended.result())


ALONE = Ranks(None, 1)
"""This process, without other ranks."""
