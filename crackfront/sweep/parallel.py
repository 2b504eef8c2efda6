"""Tasks over MPI ranks, or one after the other without MPI, until a stop is requested.

This is the only importer of mpi4py. A stop is requested by SIGTERM, which a batch system sends some
time before it kills, by Ctrl-C or by closing the terminal. Some launchers kill their ranks instead
of passing signals on; the process that started a launcher therefore leaves its ranks a file, and
they end with that process, however it ends.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import itertools
import os
import secrets
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Generator, Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, TypeVar

from crackfront.data.bounds import counted

if TYPE_CHECKING:
    from mpi4py import MPI

Task = TypeVar("Task")
Result = TypeVar("Result")
Kept = TypeVar("Kept")

_STOP_FILE = "CRACKFRONT_STOP"
"""Environment variable that names the file by which ranks are requested to stop."""

_STOPPED = "ended"
"""Text that the manager writes into this file before it stops."""

_ALIVE = b"\n"
"""First byte on the standard input of the ranks, which the process of the launcher keeps open."""

_COUNT_VARIABLES = (
    *("PMI_SIZE", "MPI_LOCALNRANKS", "OMPI_COMM_WORLD_SIZE", "MV2_COMM_WORLD_SIZE"),
    *("SLURM_STEP_NUM_TASKS", "JSM_NAMESPACE_SIZE", "FLUX_JOB_SIZE"),
)
"""Environment variables in which launchers state how many processes they start.

SLURM_NTASKS is not among them: a batch script, which is one process, has that of its job.
"""

_RANK_VARIABLES = (
    *("PMI_RANK", "PMIX_RANK", "MPI_LOCALRANKID", "OMPI_COMM_WORLD_RANK", "MV2_COMM_WORLD_RANK"),
    *("SLURM_PROCID", "PALS_RANKID", "ALPS_APP_PE", "JSM_NAMESPACE_RANK", "FLUX_TASK_RANK"),
)
"""Environment variables in which launchers number processes from 0; some launchers set no other."""

_POLL_SECONDS = 0.02
"""Time between two polls of a launcher. (Units: s)"""

_LONGEST_NAP = 0.001
"""Longest time between two looks for a message. (Units: s)"""

_GRACE_SECONDS = 10.0
"""Time that a launcher has to end its ranks before it is killed. (Units: s)"""

_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Signals that request a stop; one that was ignored at the start of the process stays ignored."""

_received = threading.Event()


def stop_is_requested() -> bool:
    """Whether this process is to store what it has and end."""
    name = os.environ.get(_STOP_FILE)
    return _received.is_set() or (name is not None and Path(name).exists())


def is_launched() -> bool:
    """Whether another crackfront process started this one as one of its ranks."""
    return _STOP_FILE in os.environ


def report_stop_to_launcher() -> bool:
    """Write into the launcher's file that this rank stops on request; return whether it has one.

    The rank then ends with 0, as MPI reports any other exit code as a failure.
    """
    with contextlib.suppress(KeyError, OSError):
        Path(os.environ[_STOP_FILE]).write_text(_STOPPED, encoding="utf-8")
        return True
    return False


@contextlib.contextmanager
def deferring_stops() -> Iterator[None]:
    """Let signals only set :func:`stop_is_requested`; a second Ctrl-C ends the process at once."""

    def receive(number: int, frame: FrameType | None) -> None:
        if number == signal.SIGINT and _received.is_set():
            raise KeyboardInterrupt
        if not (_received.is_set() or under_mpi()):
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


def under_mpi() -> bool:
    """Whether this process is a rank: one started as `python -m mpi4py -m crackfront`."""
    return "mpi4py.run" in sys.modules


def is_manager(n_worker: int) -> bool:
    """Whether this process plans and reports, beside so many that compute; always without MPI.

    On the manager ValueError, and on the other ranks SystemExit, if the number of ranks is another
    one, as by a launcher of another MPI library, which starts processes of one rank each. Without
    MPI ValueError if a launcher has started several of these processes, each of which would do the
    whole work.
    """
    if not under_mpi():
        if launched := _launched_several_times():
            raise ValueError(
                f"a launcher has started this command {launched}; leave that to --ranks and "
                "--launcher, or start ranks as python -m mpi4py -m crackfront"
            )
        return True
    from mpi4py import MPI

    world = MPI.COMM_WORLD
    if world.size == n_worker + 1:
        if world.rank == 0 and is_launched():
            threading.Thread(target=_end_with_launcher, args=(world.Abort,), daemon=True).start()
        return world.rank == 0
    if world.rank != 0:
        # The first that exits ends them all; the manager prints its sentence before.
        time.sleep(5)
        sys.exit(2)
    raise ValueError(
        f"MPI started {counted(world.size, 'rank')} where {n_worker + 1} were expected, "
        f"{counted(n_worker, 'worker')} and a manager; launch workers + 1, by the launcher that "
        "belongs to mpi4py's MPI library"
    )


def _launched_several_times() -> str:
    """How often a launcher has started this command, in words; empty if once or unknown."""
    for name in _RANK_VARIABLES:
        if (rank := _environment_number(name)) > 0:
            return f"several times, {name} is {rank}"
    # A shell on the first of several tasks has what they have, and is alone.
    sizes = () if "SLURM_PTY_PORT" in os.environ else _COUNT_VARIABLES
    name = max(sizes, key=_environment_number, default="")
    count = _environment_number(name) if name else 0
    return f"{count} times, as {name} says" if count > 1 else ""


def _environment_number(name: str) -> int:
    """Whole number in an environment variable; 0 where there is none."""
    text = os.environ.get(name, "").strip()
    return int(text) if text.isdecimal() else 0


def _end_with_launcher(abort: Callable[[int], object]) -> None:
    """End all ranks when the process that started the launcher is gone, which closes this input."""
    # A launcher that passes no input on closes it before the first byte: its end then says nothing.
    if os.read(0, 1) == _ALIVE:
        while os.read(0, 1):
            pass
        abort(1)


def _nothing() -> None:
    """Do nothing."""


def serve_tasks(module: str) -> None:
    """Compute what the manager hands out until it has no more.

    The module of the tasks' function is imported while the manager still plans.
    """
    importlib.import_module(module)
    from mpi4py import MPI

    world = MPI.COMM_WORLD
    while (handed := world.recv(source=_sender(world))) is not None:
        function, task = handed
        try:
            answer = function(task, _nothing), ""
        except Exception:  # the manager raises one with this text
            answer = None, traceback.format_exc()
        _nap_until(functools.partial(_is_sent, world.isend(answer, 0)))


def _is_sent(request: MPI.Request) -> bool:
    """Whether a message has left this rank."""
    return bool(request.Test())


def _sender(world: MPI.Intracomm, idle: Callable[[], None] = _nothing) -> int:
    """Wait for a message, calling a function meanwhile; return the rank that sent it."""
    from mpi4py import MPI

    status = MPI.Status()
    _nap_until(lambda: world.iprobe(status=status), idle)
    return status.Get_source()


def _nap_until(ready: Callable[[], bool], idle: Callable[[], None] = _nothing) -> None:
    """Wait without taking the core from other ranks, as a wait inside of MPI would."""
    nap = 0.0
    while not ready():
        time.sleep(nap)
        idle()
        nap = min(_LONGEST_NAP, 2 * nap + 1e-6)


def run_tasks(
    function: Callable[[Task, Callable[[], None]], Result],
    tasks: Sequence[Task],
    keep: Callable[[Task, Result], Kept],
    idle: Callable[[], None] = _nothing,
) -> Generator[tuple[Task, Kept]]:
    """Tasks with what is kept of them, as they end; a free rank starts the next of the list.

    Without MPI the tasks run here, one after the other. With MPI this is called by the manager
    while the other ranks are in :func:`serve_tasks`, also where there is no task. The longest tasks
    stand first. The function is a module's; it and the tasks travel by pickle. It takes a task, and
    `idle`, which it calls from time to time where it runs in this process; else this process calls
    it while it waits. `keep` takes every task and its result here, also of those that end while
    this is closed. RuntimeError
    with the traceback if a task fails on a rank, when those that run beside it have ended.
    """
    if not under_mpi():
        for task in tasks:
            yield task, keep(task, function(task, idle))
        return
    from mpi4py import MPI

    world = MPI.COMM_WORLD
    left = iter(tasks)
    running: dict[int, tuple[Task, MPI.Request]] = {}

    def hand_out(rank: int) -> None:
        # The next task, if one is left.
        for task in itertools.islice(left, 1):
            running[rank] = task, world.isend((function, task), rank)

    def take_in() -> tuple[int, Task, Any, str]:
        rank = _sender(world, idle)
        task, sent = running.pop(rank)
        sent.wait()
        return rank, task, *world.recv(source=rank)

    try:
        for rank in range(1, world.size):
            hand_out(rank)
        while running:
            rank, task, result, failure = take_in()
            if failure:
                raise RuntimeError(f"rank {rank} failed:\n{failure}")
            hand_out(rank)  # it computes while this one stores
            yield task, keep(task, result)
    finally:
        while running:
            _, task, result, failure = take_in()
            if not failure:
                keep(task, result)
        for rank in range(1, world.size):
            world.send(None, rank)


def default_launcher() -> str:
    """The `mpiexec` beside this Python, or else the one on the path; refused where none is."""
    beside = Path(sys.executable).with_name("mpiexec")
    found = str(beside) if beside.exists() else shutil.which("mpiexec")
    if found is None:
        raise ValueError(
            f"there is no mpiexec beside {sys.executable} or on the path; run `make env`, name a "
            "launcher (--launcher) or use one rank"
        )
    return shlex.quote(found)


def launch_ranks(
    arguments: Sequence[str], n_worker: int, launcher: str | None, folder: Path
) -> int | None:
    """Exit code of a crackfront command that is run on a manager and a number of workers.

    It is None if the manager stopped on request. The first signal that requests a stop leaves the
    ranks a file in the folder, which all ranks see; the second ends the launcher, which is killed
    where it does not end. What the ranks print is passed on as long as it is read. The launcher
    takes `-n` and a number, as "srun -K1 --overcommit --mpi=pmi2" does. ValueError if there is
    none, or it cannot be started.
    """
    # Under -m mpi4py a rank that fails ends the job, where it would else hang.
    command = [
        *_launcher_command(launcher or default_launcher()),
        *("-n", str(n_worker + 1)),
        *(sys.executable, "-m", "mpi4py", "-m", "crackfront"),
        *arguments,
    ]
    file = folder / f".stop-{secrets.token_hex(8)}"
    environment = {"OMP_NUM_THREADS": "1"} | dict(os.environ) | {_STOP_FILE: str(file)}
    try:
        # A group of its own: Ctrl-C reaches this process alone, and not the launcher, which would
        # kill the ranks. From the background none of them may read the terminal.
        process = subprocess.Popen(
            command,
            bufsize=0,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            process_group=0,
        )
    except OSError as error:
        raise ValueError(
            f"launcher {command[0]!r} cannot be started ({error.strerror}); name another one"
        ) from error

    def leave_file(number: int, frame: FrameType | None) -> None:
        try:
            file.touch(exist_ok=False)
            _announce_stop()
        except OSError:  # the second time, or where nothing can be written
            process.terminate()
            # Ranks that wait in a library for each other end no other way.
            killer = threading.Timer(_GRACE_SECONDS, process.kill)
            killer.daemon = True
            killer.start()

    assert process.stdin is not None, "it is a pipe"
    streams = [one for one in (process.stdout, process.stderr) if one is not None]
    readers = [
        threading.Thread(target=_pass_on, args=(stream.fileno(), number), daemon=True)
        for number, stream in enumerate(streams, start=1)
    ]
    try:
        with _handling_stops(leave_file):
            for reader in readers:
                reader.start()
            with contextlib.suppress(BrokenPipeError):
                process.stdin.write(_ALIVE)
            # Without an end of its own, a wait that begins as a signal arrives would not heed it.
            while (code := process.poll()) is None:
                time.sleep(_POLL_SECONDS)
            for reader in readers:
                # A process that outlives the launcher may hold its output.
                reader.join(_GRACE_SECONDS)
        ended = file.exists() and file.read_text(encoding="utf-8") == _STOPPED
        return None if code == 0 and ended else code
    finally:
        if process.poll() is None:
            process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_GRACE_SECONDS)
            process.kill()
            process.wait()
        process.stdin.close()
        for reader, stream in zip(readers, streams, strict=True):
            if not reader.is_alive():
                stream.close()
        file.unlink(missing_ok=True)


def _launcher_command(launcher: str) -> list[str]:
    """Name and options of a launcher."""
    try:
        if words := shlex.split(launcher):
            return words
    except ValueError as error:
        raise ValueError(f"launcher {launcher!r} cannot be read: {error}") from error
    raise ValueError(f"launcher {launcher!r} names none; leave it out for mpiexec")


def _pass_on(source: int, number: int) -> None:
    """Copy what is written into a pipe to an output, and to nowhere once nobody reads that."""
    while chunk := os.read(source, 2**16):
        rest = memoryview(chunk)
        while rest:
            try:
                rest = rest[os.write(number, rest) :]
            except OSError:
                break
