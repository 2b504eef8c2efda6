"""Generated input: whatever a command is given, it answers with a result or with one sentence.

Every case is the number of a fixed seed: a failure names it, and `fault` of it repeats it.
"""

import gc
import json
import math
import os
import resource
import shlex
import signal
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import netCDF4
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.core import jkr
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, LATERAL, VERTICAL
from crackfront.sweep.curves import SIMULATION, selected
from tests.commands import curve_paths
from tests.yaml_texts import to_yaml

SEED = 20261122
FEW = 3
"""Cases of each kind by day; the others are left to the night."""
ANSWERS = (0, 3)
"""Exit codes of a command that has an answer, without or with reservations."""

SECONDS, BYTES = 20, 4 * 10**9
"""Time and memory after which a case hangs or takes too much."""

ODD = (
    *(0, -1, 1, 2, 3, 7, 0.5, 0.1, 1e-3, 2.5, 100, 10**5, 10**6, 10**9, 10**12, 2**63, 2**64),
    *(10**30, -(10**30), 1e-300, 1e300, 1e308, -1e308, 1e30, 1e-30, 1e-12, 1e12, 5e-324, 1e15),
    *(math.nan, math.inf, -math.inf),
)
"""Numbers that nobody means, beside a few that somebody may."""

OTHERS = (
    None,
    True,
    "",
    "text",
    "1e3",
    "0.1m",
    [],
    {},
    [1, 2],
    {"a": 1},
    [[]],
    "é\u2028",
    "a" * 5000,
)


@dataclass(frozen=True)
class Case:
    """A command, and what is wrong with a result that it calls good."""

    arguments: list[str]
    wrong: Callable[[str], str] = lambda output: ""


class TooLong(BaseException):
    """A case that does not end."""


class Told(BaseException):
    """A case that has told that it takes long."""


def announcement(task, seconds, **_):
    """What stands in for the announcement of a cost: nobody waits for it here."""
    if seconds > SECONDS / 4:
        raise Told


def fault(case):
    """What is wrong with the answer to a case; empty where nothing is."""

    def ring(number, frame):
        raise TooLong

    before = {bell: signal.signal(bell, ring) for bell in (signal.SIGALRM, signal.SIGPROF)}
    limits = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + BYTES, limits[1]))
    # Processor time, and much more of the clock's: a machine may be busy with other things.
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    signal.alarm(6 * SECONDS)
    try:
        with ExitStack() as stack:
            for module in ("cycle_command", "sweep_commands"):
                function = f"crackfront.cli.{module}.announce_cost"
                stack.enter_context(mock.patch(function, announcement))
            result = CliRunner().invoke(main, case.arguments)
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            return f"traceback: {type(result.exception).__name__}: {result.exception}"[:300]
        if result.exit_code not in range(5):
            return f"exit code {result.exit_code}"
        if result.exit_code in (1, 2) and not result.stderr.strip():
            return f"silent: exit code {result.exit_code} without a sentence"
        if len(result.output) > 30_000:
            return f"flood: {len(result.output)} characters: {result.output[:200]}"
        return case.wrong(result.stdout) if result.exit_code in ANSWERS else ""
    except Told:
        return ""
    except TooLong:
        return "hang"
    finally:
        signal.alarm(0)
        signal.setitimer(signal.ITIMER_PROF, 0)
        for bell, handler in before.items():
            signal.signal(bell, handler)
        resource.setrlimit(resource.RLIMIT_AS, limits)


def odd_number(rng):
    """A number that nobody means, or of any magnitude."""
    if rng.random() < 0.6:
        return ODD[rng.integers(len(ODD))]
    number = 10 ** rng.uniform(-14, 14) * rng.choice([1, 1, 1, -1])
    return int(number) if rng.random() < 0.3 else float(number)


def odd_value(rng):
    """A number, or something else."""
    return odd_number(rng) if rng.random() < 0.75 else OTHERS[rng.integers(len(OTHERS))]


def chosen(rng, options):
    """One of a few."""
    return options[int(rng.integers(len(options)))]


def places(content, at=()):
    """All places of a nested mapping or list, and what stands there."""
    items = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in list(items):
        yield (*at, key), value
        if isinstance(value, dict | list):
            yield from places(value, (*at, key))


NUMERICS = {
    "angles": 16,
    "samples_per_cutoff": 4,
    "interpolation": "cubic",
    "pixels_per_cutoff": 4,
    "tile": {"roll_offs": 4, "cutoffs": 8},
    "tolerance": 1e-6,
    "max_sweeps": 100000,
    "solver": "newton",
}
LINE = {"springs": [4.0], "length": 10.0, "period": 20.0, "transient": 3.0, "step": 2.0}


def good_configuration(rng):
    """A small configuration of one of the kinds."""
    kind = chosen(rng, ("cycle", "steady", "line", "chemical", "asked", "metres"))
    content = {
        "seed": 1,
        "field": "chemical" if kind == "chemical" else "roughness",
        "spectra": [{"name": "rough", "short_cutoff": 0.5, "roll_off": 0.8, "hurst": 0.8}],
        "amplitudes": {"elastic_energy": [0.02]},
        "realisations": 1,
        "numerics": NUMERICS | {"tile": dict(NUMERICS["tile"])},
        "load": {"max_penetration": 0.5, "step": 0.25},
        "fit": {"lowest_elastic_energy": 0.01, "highest_elastic_energy": 0.1, "bootstrap": 100},
    }
    if kind == "chemical":
        content["amplitudes"] = {"work_of_adhesion_rms": [0.3]}
    if kind == "steady":
        steady = {"start": 0.1, "travel": 2.0, "error": 0.5}
        content["load"] = {"max_penetration": 1.0, "steady": steady}
    if kind == "line":
        content["load"] = {"line": dict(LINE)}
    if kind == "asked":
        asked = {"error": 0.1, "tile": dict(NUMERICS["tile"]), "max_sweeps": 1000}
        content["numerics"] = asked | {"solver": "newton"}
    if kind == "metres":
        scales = {"radius": 1e-3, "work_of_adhesion": 0.05, "contact_modulus": 1e6}
        content["scales"] = scales
        content["spectra"][0] |= {"short_cutoff": 3e-5, "roll_off": 5e-5}
        content["load"] = {"max_penetration": 1e-6, "step": 5e-7}
    return content


def mutated(rng, content):
    """The same with a change at a few places."""
    for _ in range(int(rng.integers(0, 4))):
        everywhere = list(places(content))
        leaves = [place for place, value in everywhere if not isinstance(value, dict | list)]
        *way, key = chosen(
            rng, leaves if rng.random() < 0.8 else [place for place, _ in everywhere]
        )
        part = content
        for step in way:
            part = part[step]
        change = rng.random()
        if isinstance(part[key], int | float) and change < 0.7:
            altered = part[key] * 10 ** rng.normal(0, 1.5) if change < 0.5 else odd_number(rng)
            whole = isinstance(part[key], int) and math.isfinite(altered)
            part[key] = int(altered) if whole else altered
        elif change < 0.8:
            part[key] = odd_value(rng)
        elif change < 0.9:
            del part[key]
        elif isinstance(part, dict):
            part[chosen(rng, ("unknown", "Seed", "steps", "<<", 3))] = odd_value(rng)
        else:
            part.append(part[0])
    return content


def harsh_text(rng, text):
    """A text of YAML that no section sees as it stands."""
    lines = text.splitlines()
    place = int(rng.integers(len(lines) + 1))
    size = int(rng.integers(1, 7))
    more = {
        "itself": "x: &a [*a]",
        "itself in a mapping": "x: &a {b: *a}",
        "laughs": "\n".join(
            ["l0: &l0 [lol, lol]"]
            + [f"l{k}: &l{k} [{', '.join([f'*l{k - 1}'] * 9)}]" for k in range(1, 4 * size)]
        ),
        "depth": "x: " + "[" * 10**size + "]" * 10**size if size < 6 else "x: " + "{a: " * 5000,
        "keys": "\n".join(f"key_{k}: {k}" for k in range(20_000)),
        "twice": "seed: 2",
        "merged": "<<: {seed: 3}",
        "tag": "x: !!python/object/apply:os.system [ls]",
        "unknown tag": "x: !thing 3",
        "digits": "seed2: " + "9" * 10 ** min(size, 5),
        "date": "x: 2026-99-99",
        "complex key": "? [1, 2]\n: 3",
        "nul": "x: \0",
        "tab": "\tx: 1",
        "dots": "...\n---\nx: 1",
        "long list": f"amplitudes: {{elastic_energy: [{'0.05, ' * 10 ** min(size, 4)}]}}",
        "many amplitudes": "amplitudes2: [" + ", ".join(str(k) for k in range(20_000)) + "]",
    }
    lines.insert(place, more[chosen(rng, list(more))])
    return "\n".join(lines) + "\n"


def written_configuration(rng, path):
    """File of a configuration, changed or damaged."""
    text = to_yaml(mutated(rng, good_configuration(rng)))
    kind = rng.random()
    if kind < 0.15:
        text = harsh_text(rng, text)
    content = text.encode(chosen(rng, ("utf-16", "latin-1")) if kind > 0.98 else "utf-8", "replace")
    if 0.15 < kind < 0.2:
        content = flipped(rng, content)
    path.write_bytes(content)


def flipped(rng, content):
    """Bytes of which a few are others, or which end early."""
    damaged = bytearray(content)
    for _ in range(int(rng.integers(1, 6))):
        damaged[int(rng.integers(len(damaged)))] = int(rng.integers(256))
    return bytes(damaged[: int(rng.integers(len(damaged)))] if rng.random() < 0.3 else damaged)


def special_file(rng, path):
    """Something of that name that is no file."""
    kind = chosen(rng, ("folder", "pipe", "zero", "missing", "loop", "empty"))
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "zero":
        path.symlink_to("/dev/zero")
    elif kind == "loop":
        path.symlink_to(path)
    elif kind == "empty":
        path.touch()


def configuration_case(rng, folder):
    """The plan of a configuration, and the run of a small one."""
    path = folder / "sweep.yaml"
    if rng.random() < 0.04:
        special_file(rng, path)
    else:
        written_configuration(rng, path)
    store = folder / "sweep"

    def wrong(output):
        plan = json.loads(output)
        numbers = [plan[name] for name in ("core_seconds", "longest_seconds", "bytes_a_rank")]
        if not all(0 < number < math.inf for number in numbers):
            return f"wrong: costs {numbers}"
        count = plan["realisations"] * len(plan["spectra"]) * len(plan["elastic_energies"])
        if not plan["simulations"] == plan["missing"] == count:
            return f"wrong: {plan['simulations']} simulations, not {count}"
        if plan["core_seconds"] > 0.5 or plan["simulations"] > 2:
            return ""
        result = CliRunner().invoke(main, ["simulate", str(path), "--output", str(store)])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            return f"traceback: run: {type(result.exception).__name__}: {result.exception}"
        paths = curve_paths(store) if result.exit_code == 0 else []
        content = (
            selected(dataset, np.array([place]))
            for dataset in map(xr.load_dataset, paths)
            for place in range(dataset.sizes[SIMULATION])
        )
        return next((told for curve in content if (told := wrong_curve(curve))), "")

    return Case(["plan", str(path), "--output", str(store), "--json"], wrong)


def wrong_curve(curve):
    """What cannot be true of the states of a dataset; empty where nothing is."""
    if not curve.get("n_state", True):  # it failed before its first state
        return ""
    place = "mean_radius" if "mean_radius" in curve else "mean_position"
    if not np.all(np.isfinite(curve[place])) or not np.all(np.isfinite(curve["residual"])):
        return "wrong: a state that is not finite"
    if "tolerance" in curve.attrs and np.any(curve["residual"] > curve.attrs["tolerance"]):
        return "wrong: a residual above the tolerance"
    for direction in (1, -1):
        ways = direction * np.diff(curve[place].values[curve["direction"].values == direction])
        if np.any(ways < -1e-9 * np.max(np.abs(curve[place].values), initial=1.0)):
            return "wrong: a front that moved back"
    return ""


FIELDS = ("tile", "height", "library", "line")


def good_field(rng, kind):
    """A small field, as the file would have it, and the options of its cycle."""
    n = 2 * int(rng.integers(2, 8))
    shape, dims = (n, n), ("x", "y")
    coordinates = {"x": np.linspace(0, 2, n, endpoint=False), "y": np.linspace(0, 2, n, False)}
    values = rng.uniform(-1, 1, shape) * chosen(rng, (0.0, 0.1, 0.5))
    name, attributes = "work_of_adhesion", {}
    if kind in ("height", "library"):
        unit = {"units": LATERAL}
        coordinates = {axis: (axis, steps - 1, unit) for axis, steps in coordinates.items()}
    if kind == "height":
        name, values = "height", 0.05 * values
        attributes = {"units": VERTICAL}
    elif kind == "library":
        values, attributes = 1 + values, {"units": ADHESION}
    else:
        values = WORK_OF_ADHESION * (1 + values)
    dataset = xr.Dataset({name: (dims, values, attributes)}, coords=coordinates)
    sphere = ["--max-penetration", "0.3", "--step", "0.15"]
    line = ["--spring", "1", "--loads", "0,1,0", "--step", "0.5"]
    return dataset, line if kind == "line" else sphere


def changed_field(rng, dataset):
    """A field with a change or two."""
    for _ in range(int(rng.integers(0, 3))):
        [name] = dataset.data_vars
        values, coordinate = dataset[name], chosen(rng, list(dataset.coords) or ["x"])
        size = dataset[coordinate].size if coordinate in dataset else 0
        kind = chosen(
            rng, ("value", "value", "all", "place", "axis", "type", "units", "name", "cut")
        )
        if kind == "value":
            # A copy: what is shared would change too.
            data = values.values.astype(float, copy=True)
            data.flat[int(rng.integers(data.size)) if data.size else 0 : 1] = odd_number(rng)
            data.ravel()[: min(1, data.size)] = odd_number(rng)
            dataset = dataset.assign({name: (values.dims, data, values.attrs)})
        elif kind == "all":
            with np.errstate(all="ignore"):
                dataset = dataset.assign({name: values.astype(float) * float(odd_number(rng))})
        elif kind == "place" and size > 0:
            data = dataset[coordinate].values.astype(float, copy=True)
            data[int(rng.integers(size))] = odd_number(rng)
            dataset = dataset.assign_coords({coordinate: (coordinate, data)})
        elif kind == "axis" and size > 0:
            with np.errstate(all="ignore"):
                data = dataset[coordinate].values * float(odd_number(rng))
            dataset = dataset.assign_coords({coordinate: (coordinate, data)})
        elif kind == "type":
            kinds = ("int8", "float32", "uint64", "str", "bool")
            with np.errstate(all="ignore"):
                data = np.nan_to_num(values.values.astype(float)).astype(chosen(rng, kinds))
            dataset = dataset.assign({name: (values.dims, data, values.attrs)})
        elif kind == "units":
            units = chosen(rng, ("m", "J/m^2", "1", "w_int", "reduced", "", 3.0))
            dataset = dataset.assign({name: values.assign_attrs(units=units)})
        elif kind == "name":
            dataset = dataset.rename({name: chosen(rng, ("height", "w", "work_of_adhesion2"))})
        elif kind == "cut":
            axis = chosen(rng, values.dims)
            dataset = dataset.isel({axis: slice(0, int(rng.integers(0, 5)))})
    return dataset


def claim(rng, path):
    """A file of a few bytes that says that it holds a field of any size."""
    with netCDF4.Dataset(path, "w") as file:
        for name in ("x", "y"):
            side = int(10 ** rng.uniform(3, 6))
            file.createDimension(name, side)
            if rng.random() < 0.5:
                file.createVariable(name, "f8", (name,))[:] = np.arange(side)
        chunks = (1000, 1000)
        file.createVariable("work_of_adhesion", "f8", ("x", "y"), zlib=True, chunksizes=chunks)


def field_case(rng, folder):
    """A cycle on a field from a file."""
    path, output = folder / "field.nc", folder / "out.nc"
    dataset, options = good_field(rng, chosen(rng, FIELDS))
    values = dataset[next(iter(dataset))].values.copy()
    kind = rng.random()
    same = kind >= 0.2
    if kind < 0.04:
        special_file(rng, path)
    elif kind < 0.1:
        claim(rng, path)
    else:
        changed = changed_field(rng, dataset)
        same = changed.identical(dataset) and same
        changed.to_netcdf(path)
        if kind < 0.2:
            path.write_bytes(flipped(rng, path.read_bytes()))
    arguments = ["cycle", "--field", str(path), *options, "--output", str(output)]

    def wrong(_):
        if told := wrong_curve(xr.load_dataset(output)):
            return told
        written = xr.load_dataset(output)
        if same and "penetration" in written and np.all(values == WORK_OF_ADHESION):
            exact = [
                jkr.equilibrium_radius(float(penetration)) for penetration in written["penetration"]
            ]
            if not np.allclose(written["mean_radius"], exact, rtol=1e-3):
                return "wrong: a smooth field that is not that of JKR"
        result = CliRunner().invoke(main, [*arguments, "--solver", "reference"])
        if result.exit_code != 0:
            return f"wrong: the reference says {result.stderr}"
        cycle, place = xr.load_dataset(output), "mean_radius"
        place = place if place in cycle else "mean_position"
        if cycle.sizes != written.sizes or not np.allclose(cycle[place], written[place], atol=1e-4):
            return "wrong: the reference finds other states"
        return ""

    return Case(arguments, wrong)


def good_commands(folder):
    """Commands with options that are good, all of them cheap."""
    n = 8
    axis = np.linspace(0, 2, n, endpoint=False)
    values = WORK_OF_ADHESION * (1 + 0.2 * np.cos(np.pi * axis)[:, None] * np.ones(n))
    tile = folder / "tile.nc"
    xr.Dataset({"work_of_adhesion": (("x", "y"), values)}, coords={"x": axis, "y": axis}).to_netcdf(
        tile
    )
    scan = folder / "scan.npy"
    np.save(scan, 1e-8 * np.random.default_rng(1).standard_normal((36, 36)))
    sweep = folder / "sweep.yaml"
    sweep.write_text(to_yaml(good_configuration(np.random.default_rng(3))))
    output, store = folder / "out.nc", folder / "store"
    cycle = f"cycle --output {output} --field"
    tuned = "--error 0.1"
    line = "--spring 1 --loads 0,1,0 --step 0.5"
    surface = f"surface {scan} --unit m --size 2e-5,2e-5 --json"
    sphere = "--modulus 0.7MPa --poisson 0.5 --radius 1.25mm --work-of-adhesion 63mJ/m2"
    lines = (
        "law --w-rms 0.4 --g 10 --json",
        "law --spectrum 0.005,0.1,0.3 --elastic-energy 0.05 --contact-radius 1.9 --json",
        f"{cycle} {tile} --max-penetration 0.3 --step 0.1 {tuned}",
        f"{cycle} {tile} --max-penetration 0.3 --step 0.1 {tuned}",
        f"{cycle} {tile} {line} {tuned}",
        f"{surface} --shortest 3um",
        f"{surface} {sphere}",
        f"plan {sweep} --output {store} --block 1 --json",
        f"simulate {sweep} --output {store} --realisations 0-0 --checkpoint 60",
    )
    return [shlex.split(text) for text in lines]


UNITS = ("", "m", "um", "MPa", "Pa", "mJ/m2", "J/m2", "kg", "m^9", "1/m", "m**99", "(m", "m+Pa")


def option_case(rng, folder):
    """A command with options of any value."""
    command = chosen(rng, good_commands(folder))
    spots = [k for k, part in enumerate(command) if k > 1 and command[k - 1].startswith("--")]
    spots = [k for k in spots if not command[k].startswith("--") and "/" not in command[k]]
    spots += [k for k, part in enumerate(command) if part.endswith("mJ/m2")]
    for k in rng.permutation(spots)[: int(rng.integers(1, 3))]:
        text = str(odd_value(rng))
        if command[k][-1].isalpha() or command[k].endswith("m2"):
            text += chosen(rng, UNITS)
        if "," in command[k]:
            text = ",".join([text] * int(rng.integers(1, 5)))
        command[k] = text
    if rng.random() < 0.1:
        command.insert(
            int(rng.integers(1, len(command))), chosen(rng, ("--nonsense", "", "-", "x"))
        )
    output = folder / "out.nc"

    def wrong(told):
        if "--json" in command and not finite(json.loads(told)):
            return f"wrong: {told}"
        return wrong_curve(xr.load_dataset(output)) if command[0] == "cycle" else ""

    return Case(command, wrong)


def finite(content):
    """Whether all numbers of a value of JSON are such."""
    if isinstance(content, dict | list):
        parts = content.values() if isinstance(content, dict) else content
        return all(finite(part) for part in parts)
    return not isinstance(content, float) or math.isfinite(content)


N_POINT = 36


def written_scan(rng, heights, path):
    """A map as an array or as text, in which a cell, a row or a line may be no number."""
    if path.suffix == ".npy":
        np.save(path, heights)
        return
    rows = [[f"{value:.9e}" for value in row] for row in heights.T]
    harm = rng.random()
    if harm < 0.6:
        marks = ("***", "1,5", "nan", "", "NaN", "inf", "1e308", "-", "#", "x", "1e-300", "--")
        for _ in range(int(rng.integers(1, 4))):
            chosen(rng, rows)[int(rng.integers(N_POINT))] = chosen(rng, marks)
    elif harm < 0.7:
        del chosen(rng, rows)[int(rng.integers(N_POINT))]
    elif harm < 0.8:
        rows.insert(int(rng.integers(N_POINT)), ["text"])
    between = chosen(rng, (" ", "\t"))
    path.write_text("\n".join(between.join(row) for row in rows) + "\n")


def scan_case(rng, folder):
    """The analysis of a scan: refused, or of the map that was written."""
    path = folder / chosen(rng, ("scan.asc", "scan.asc", "scan.npy"))
    heights = 1e-8 * rng.standard_normal((N_POINT, N_POINT))
    kind = rng.random()
    if kind < 0.06:
        special_file(rng, path)
    else:
        written_scan(rng, heights, path)
        if kind < 0.2:
            path.write_bytes(flipped(rng, path.read_bytes()))
    expected = float(np.std(heights))

    def wrong(told):
        content = json.loads(told)
        [scan], rms = content["measurements"], content["measures"][0]["rms"]["value"]
        if not finite(content):
            return "wrong: a number that is not finite"
        # Flipped bytes may be another map.
        if kind >= 0.2 and scan["points"] != [N_POINT, N_POINT]:
            return f"wrong: {scan['points']} points"
        if kind >= 0.2 and not 0.2 < rms / expected < 1.1:
            return f"wrong: rms height {rms:.5g} of some waves, {expected:.5g} of all"
        return ""

    options = ["--unit", "m", "--size", "2e-5,2e-5", "--detrend", "center", "--json"]
    return Case(["surface", str(path), *options], wrong)


CASES = {
    "configurations": configuration_case,
    "fields": field_case,
    "options": option_case,
    "scans": scan_case,
}


def numbered_case(kind, number, folder):
    """The case of a number."""
    folder.mkdir(parents=True)
    spawn = (list(CASES).index(kind), number)
    return CASES[kind](np.random.default_rng(np.random.SeedSequence(SEED, spawn_key=spawn)), folder)


def faults(kind, numbers, folder):
    """Faults of the cases of some numbers."""
    failures = {}
    for number in numbers:
        if told := fault(numbered_case(kind, number, folder / f"{kind}-{number}")):
            failures[number] = told
    return failures


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """Kernels for all kinds of fields and both solvers, whose compilation is no hang."""
    folder = tmp_path_factory.mktemp("compiled")
    for kind in FIELDS:
        dataset, options = good_field(np.random.default_rng(0), kind)
        dataset.to_netcdf(folder / f"{kind}.nc")
        for solver in ("newton", "reference"):
            arguments = ["cycle", "--field", str(folder / f"{kind}.nc"), *options]
            arguments += ["--solver", solver, "--output", str(folder / "out.nc")]
            assert CliRunner().invoke(main, arguments).exit_code == 0


@pytest.mark.usefixtures("compiled")
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("kind", CASES)
def test_no_generated_input_ends_in_a_traceback_a_hang_or_a_wrong_result(
    kind, tmp_path, monkeypatch
):
    # Few draws fail where many do.
    monkeypatch.setattr("crackfront.measured.spectrum.draws.BATCHES", (1,))
    monkeypatch.setattr("crackfront.measured.spectrum.draws.BATCH", 2**6)
    with np.errstate(all="warn", under="ignore"):
        assert faults(kind, range(FEW), tmp_path) == {}
        # What libraries leave open warns here, and not amid another test.
        gc.collect()


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.usefixtures("compiled")
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("kind", CASES)
def test_no_generated_input_of_many_more_does(kind, tmp_path):
    with np.errstate(all="warn", under="ignore"):
        assert faults(kind, range(FEW, 2000), tmp_path) == {}
