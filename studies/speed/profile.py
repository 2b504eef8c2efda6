"""Where the processor time of default simulations goes, by kernel, as Linux's perf samples it.

The kernels are machine code without a file: perf is told their names and addresses in a map, from
the objects that numba loads.
"""

from __future__ import annotations

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from crackfront.analysis.run_measures import RunMeasures
from crackfront.core.cycle.record import Recorder
from crackfront.core.variables import variable
from crackfront.simulate.contact import Problem
from crackfront.simulate.provenance import provenance
from crackfront.simulate.run_simulation import SimulationResult, compile_solver
from crackfront.simulate.simulation import Simulation, simulation_adhesion, simulation_field
from crackfront.sweep.curves import FinishedSimulation, curves_dataset
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import sweep_row
from studies.pages import markdown_table

CONFIGURATION = Path("config/default.yaml")

CASES = (("flat", 0.01), ("flat", 0.1), ("h08", 0.1), ("h03", 0.05))
"""Simulations of the default sweep: spectrum and elastic energy, relative to w_int."""

_REPEATS = 2

_PARTS = {
    "bounds on the way ahead": r"forces\.harden|forces\.largest",
    "splines of the tile": r"samples\.|_fill|_store",
    "windows: solving and moving": r"window\.",
    "steps of the whole front, transforms": r"newton\.|filters\.|rocket_fft|ducc0",
    "Python and its libraries": r"libpython|multiarray|ld-linux|libc\.so|libm\.so|python3",
}
"""What a part of the solver is called, and the pattern of its kernels."""

_REST = "rest of the solver"


@dataclass(frozen=True, slots=True)
class Share:
    """Processor time of a part of the simulations."""

    part: str = variable("part of a simulation", "1")
    seconds: float = variable("processor time a simulation", "s")
    share: float = variable("part of the processor time of a simulation", "1")


def _simulations() -> list[Simulation]:
    sweep = load_sweep(CONFIGURATION)
    return [sweep.simulation(sweep.named(name), energy, 0) for name, energy in CASES]


def shares() -> list[Share]:
    """Shares of the parts of a simulation, the largest first.

    RuntimeError if perf is missing, or may not sample this user's processes.
    """
    if shutil.which("perf") is None:
        raise RuntimeError(
            "perf is not installed on this machine; install linux-perf or linux-tools"
        )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        samples, control, answer = (
            folder / file_name for file_name in ("samples", "control", "answer")
        )
        os.mkfifo(control)
        os.mkfifo(answer)
        perf = ["perf", "record", "--quiet", "--event", "cpu-clock:u", "--freq", "997"]
        perf += ["--delay", "-1", "--control", f"fifo:{control},{answer}"]
        perf += ["--output", str(samples), "--"]
        code = "import sys; from studies.speed.profile import run; run(*sys.argv[1:])"
        ran = subprocess.run(
            [*perf, sys.executable, "-c", code, str(control), str(answer)],
            check=False,
            capture_output=True,
            text=True,
        )
        if ran.returncode:
            raise RuntimeError(f"perf cannot sample this process: {ran.stderr.strip()[-300:]}")
        *spent, names = ran.stdout.split()[-4:]
        tile, loads, store = map(float, spent)
        reported = subprocess.run(
            ["perf", "report", "--stdio", "--input", str(samples), "--sort", "dso,sym"],
            check=True,
            capture_output=True,
            text=True,
        )
        Path(names).unlink()
    solver = _solver_shares(reported.stdout)
    seconds = {part: loads * share for part, share in solver.items()}
    seconds |= {"making the tile and its splines": tile, "making the row and the dataset": store}
    total = sum(seconds.values())
    ordered = sorted(seconds.items(), key=lambda item: -item[1])
    return [Share(part, spent, spent / total) for part, spent in ordered]


def _solver_shares(report: str) -> dict[str, float]:
    """Shares of the parts of the solver from what perf prints, which add up to 1."""
    percentages: defaultdict[str, float] = defaultdict(float)
    for percent, rest in re.findall(r"^\s+([\d.]+)%\s+(.*)$", report, re.MULTILINE):
        kernel = _kernel(rest)
        parts = (part for part, pattern in _PARTS.items() if re.search(pattern, kernel))
        percentages[next(parts, _REST)] += float(percent)
    total = sum(percentages.values())
    return {part: share / total for part, share in percentages.items()}


def _kernel(symbol: str) -> str:
    """`module.function` of a kernel; anything else as it is."""
    _, mangled, rest = symbol.partition("_ZN")
    names = []
    while mangled and (size := re.match(r"\d+", rest)):
        end = size.end() + int(size[0])
        names.append(rest[size.end() : end])
        rest = rest[end:]
    return ".".join(names[-2:]) if names else symbol


def run(control: str, answer: str) -> None:
    """Run the simulations while perf looks at the load steps.

    Prints the processor seconds a simulation of making the tile, of the load steps and of the
    dataset, and the file of the names of kernels.
    """
    objects, simulations = _loaded_objects(), _simulations()
    # The first run loads kernels, which does not belong to a simulation.
    _timed(simulations[0], lambda _: None)
    runs = [
        _timed(simulation, lambda word: _tell(control, answer, word))
        for simulation in simulations
        for _ in range(_REPEATS)
    ]
    # Where perf looks for them.
    names = Path(f"/tmp/perf-{os.getpid()}.map")
    names.write_text("".join(_map_lines(objects)), encoding="utf-8")
    spent = (sum(part) / len(runs) for part in zip(*runs, strict=True))
    click.echo(" ".join([*map(str, spent), str(names)]))


def _timed(simulation: Simulation, tell: Callable[[str], None]) -> tuple[float, float, float]:
    """Processor seconds of making the tile, of the load steps and of the dataset.

    The load steps stand between the words enable and disable.
    """
    compile_solver(simulation.solver.name, type(simulation.schedule))
    begin = time.process_time()
    adhesion = simulation_adhesion(simulation)
    problem = Problem(
        simulation_field(simulation, adhesion),
        simulation.correlation_length,
        simulation.elastic_energy,
    )
    tile_seconds = time.process_time() - begin
    tell("enable")
    begin = time.process_time()
    record = simulation.schedule.run(problem, simulation.solver, Recorder())
    load_seconds = time.process_time() - begin
    tell("disable")
    measures = RunMeasures(adhesion.e_el, adhesion.w_rms, 0.0, 0.0, 0.0, 0.0)
    arithmetic = provenance().arithmetic
    begin = time.process_time()
    row = sweep_row(SimulationResult(simulation, record, measures))
    curves_dataset([FinishedSimulation(simulation, row, record, arithmetic)]).to_netcdf()
    return tile_seconds, load_seconds, time.process_time() - begin


def _tell(control: str, answer: str, word: str) -> None:
    """Tell perf to sample or to stop, and wait until it says that it does."""
    Path(control).write_text(f"{word}\n", encoding="utf-8")
    with Path(answer).open("rb", buffering=0) as pipe:
        pipe.read(len(b"ack\n\0"))


def _loaded_objects() -> list[bytes]:
    """A list that every object is appended to that numba loads or compiles from now on."""
    from numba.core.codegen import CPUCodeLibrary

    objects: list[bytes] = []
    keep = CPUCodeLibrary._set_compiled_object

    def also_list(library: Any, content: bytes) -> Any:
        objects.append(content)
        return keep(library, content)

    CPUCodeLibrary._set_compiled_object = also_list
    return objects


def _map_lines(objects: list[bytes]) -> Iterator[str]:
    """Lines of perf's map: address, size and name of every function of the objects."""
    from numba.core.registry import cpu_target

    engine = cpu_target.target_context.codegen()._engine._ee
    for content in objects:
        functions = list(_functions(content))
        # Where each section was loaded, by the first function in it that the engine knows: the
        # object's own one. Functions in several objects may be used from another object.
        bases: dict[int, int] = {}
        for function in functions:
            if function.section not in bases and (
                address := engine.get_function_address(function.name)
            ):
                bases[function.section] = address - function.place
        for function in functions:
            if function.section in bases:
                address = bases[function.section] + function.place
                yield f"{address:x} {function.size:x} {function.name}\n"


@dataclass(frozen=True, slots=True)
class _Function:
    """A function in an object file."""

    name: str
    section: int
    place: int
    """Bytes from the start of its section."""
    size: int


def _functions(content: bytes) -> Iterator[_Function]:
    """Functions in an object file (ELF, 64 bits)."""
    (start,) = struct.unpack_from("<Q", content, 0x28)
    size, count = struct.unpack_from("<HH", content, 0x3A)
    sections = [struct.unpack_from("<IIQQQQIIQQ", content, start + i * size) for i in range(count)]
    symbols, function = 2, 2
    for section in sections:
        if section[1] != symbols:
            continue
        names = sections[section[6]][4]
        for place in range(section[4], section[4] + section[5], 24):
            name, kind, _, home, value, length = struct.unpack_from("<IBBHQQ", content, place)
            if kind & 15 == function:
                first = names + name
                word = content[first : content.index(b"\0", first)].decode()
                yield _Function(word, home, value, length)


def page(rows: list[Share]) -> str:
    """Table of the shares, and what each part would bring if it cost nothing."""
    lines = (
        f"{row.part} | {row.seconds:.3f} | {row.share:.0%} | {1 / (1 - row.share):.2f}"
        for row in rows
    )
    cases = ", ".join(f"{name} at {energy:g}" for name, energy in CASES)
    table = markdown_table("part | s a simulation | share | times faster without it", lines)
    return (
        f"Simulations of `{CONFIGURATION}`: {cases} w_int; processor time of one core, "
        f"kernels sampled by perf, {_REPEATS} runs each.\n\n{table}"
    )
