"""The command: one cycle on any field, the steps of a sweep, exit codes and sentences."""

import errno
import functools
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import click
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import crackfront as cf
from crackfront.cli import Commands, main
from crackfront.cli.answers import StoppedError
from crackfront.core.outcome import DefectError, Status
from crackfront.core.solver.relax import named_solver
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.style import save_figure
from crackfront.simulate.provenance import provenance
from crackfront.sweep.batches import BatchWriter
from crackfront.sweep.curves import FinishedSimulation
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import failed_row
from crackfront.sweep.store import Store
from tests.commands import refused, run
from tests.measured.made import DETAIL, measure_surfaces_once
from tests.places import ROOT, TEST


@pytest.fixture
def smooth_tile(tmp_path):
    """File of a tile of w_int everywhere."""
    positions = np.linspace(0, 2, 8, endpoint=False)
    xr.Dataset(
        {"work_of_adhesion": (("x", "y"), np.full((8, 8), WORK_OF_ADHESION))},
        coords={"x": positions, "y": positions},
    ).to_netcdf(tmp_path / "F.nc")
    return tmp_path / "F.nc"


@pytest.fixture(scope="module")
def rough_surface(tmp_path_factory):
    """File of a coarse rough surface of the library."""
    path = tmp_path_factory.mktemp("surface") / "surface.nc"
    cf.random_surface(0.1, 0.05, side=4, error=0.1, seed=3).to_netcdf(path)
    return path


def cycle(field, tmp_path, *more, penetration=1, step=0.25):
    """Result of a cycle on the field of a file."""
    return run(
        *("cycle", "--field", field, "--max-penetration", penetration, "--step", step),
        *("--output", tmp_path / "out.nc", *more),
    )


def test_a_cycle_that_ends_early_is_written_and_has_exit_code_one(
    rough_surface, tmp_path, monkeypatch
):
    impatient = functools.partial(named_solver, max_sweeps=3)
    monkeypatch.setattr("crackfront.core.solver.relax.named_solver", impatient)
    result = cycle(rough_surface, tmp_path)
    assert result.exit_code == 1
    assert "the solver reached its limit of sweeps" in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert xr.load_dataset(tmp_path / "out.nc").attrs["status"] == "step_limit"


LINES = """seed: 3
field: roughness
spectra: [{name: flat, short_cutoff: 1.0, hurst: 1.0}]
amplitudes: {work_of_adhesion_rms: [0.6, 0.84]}
realisations: 1
numerics:
  angles_per_cutoff: 2
  samples_per_cutoff: 4
  interpolation: cubic
  pixels_per_cutoff: 4
  tolerance: 1.0e-4
  tile: {roll_offs: 4, cutoffs: 10}
  max_sweeps: 1000000
  solver: newton
load:
  line: {springs: [1, 2], length: 10, period: 20, transient: 3, step: 1}
fit: {lowest_elastic_energy: 0.08, highest_elastic_energy: 0.2, bootstrap: 200}
"""


def test_a_sweep_of_straight_fronts_is_fitted_and_drawn(tmp_path, monkeypatch):
    def save_png(figure, stem):
        return save_figure(figure, stem.with_name(f"{stem.name}.png"))

    monkeypatch.setattr("crackfront.plots.style.save_figure", save_png)
    configuration, output = tmp_path / "lines.yaml", ("--output", tmp_path / "out")
    configuration.write_text(LINES)
    for command in ("simulate", "aggregate", "fit"):
        result = run(command, configuration, *output)
        assert result.exit_code == 0, result.output
    dataset = xr.load_dataset(tmp_path / "out/fit.nc")
    assert dataset.cell_size.attrs == {"units": "1", "long_name": dataset.cell_size.long_name}
    # The tiles have an rms of their own.
    np.testing.assert_allclose(dataset.cell_size[1], 2 * dataset.cell_size[0], rtol=0.3)
    law, weak = (
        variable.sel(bound=["low", "value", "high"])
        for variable in (dataset.cell_law_factor, dataset.k_0)
    )
    assert np.all(law[..., 0] <= law[..., 1])
    assert weak[0] < weak[1] < weak[2]
    assert (tmp_path / "out/figures/loop.png").stat().st_size > 10_000
    assert "## k by the law of docs/law.md" in (tmp_path / "out/fit.md").read_text("utf-8")


@pytest.fixture(scope="module")
def copy_store(tmp_path_factory):
    """Function that copies the simulations of a spectrum, run once for all tests, to a folder."""

    @functools.cache
    def whole(spectrum):
        folder = tmp_path_factory.mktemp(spectrum) / "store"
        result = run("simulate", TEST, "--spectrum", spectrum, "--output", folder)
        assert result.exit_code == 0, result.output
        return folder

    def copy(spectrum, folder):
        shutil.copytree(whole(spectrum), folder, dirs_exist_ok=True)

    return copy


def test_the_status_counts_what_is_done_failed_and_left(tmp_path, copy_store):
    sweep = load_sweep(TEST)
    copy_store("rough", tmp_path)
    flat, store = sweep.shards()[0], Store(tmp_path)
    simulation = next(sweep.simulations(flat.item))
    row = failed_row(simulation, "invalid", "too rough")
    writer = BatchWriter(store.curve_folder(flat), provenance(), seconds=60)
    writer.add(FinishedSimulation(simulation, row, None, "processor"))
    writer.flush()
    result = run("status", tmp_path)
    assert result.exit_code == 0, result.output
    [_, first, second, sentence] = result.output.splitlines()
    assert first.split()[:4] == ["flat", "0", "1", "3"]
    assert float(first.split()[4]) > 0
    assert second.split() == ["rough", "4", "0", "0", "0"]
    assert sentence.startswith("5 of 8 simulations have ended; no process that is seen here")
    assert json.loads(run("status", tmp_path, "--json").stdout)["running"] == []


def test_the_status_of_a_folder_without_a_sweep_is_refused(tmp_path):
    assert "is not the folder of a sweep that was begun" in refused("status", tmp_path)


@pytest.mark.parametrize("block", ["1", "1-", "2-1", "a-b", "0-9"])
def test_a_block_that_is_none_is_refused(tmp_path, block):
    result = run("simulate", TEST, "--realisations", block, "--output", tmp_path / "out")
    assert result.exit_code == 2
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["a; rm -rf b", "$(touch x)", "..", "-e", "a b", "a'b"])
def test_a_configuration_whose_name_is_no_name_for_results_is_refused(tmp_path, name):
    bad = tmp_path / f"{name}.yaml"
    bad.write_text(TEST.read_text())
    assert "the results are named after" in refused("plan", bad)


def test_simulations_without_a_value_are_counted_and_too_many_fail(tmp_path):
    limited = tmp_path / "limited.yaml"
    text = TEST.read_text().replace("max_sweeps: 100000", "max_sweeps: 2")
    text = text.replace("realisations: 2", "realisations: 1")
    for allowed, code in (("", 1), ("failed_fraction: 1.0\n", 0)):
        limited.write_text(text + allowed)
        # The second time they are stored, as what is allowed is no part of them.
        assert run("simulate", limited, "--output", tmp_path).exit_code == 0
        (tmp_path / "hysteresis.nc").unlink(missing_ok=True)
        result = run("aggregate", limited, "--output", tmp_path)
        assert result.exit_code == code
        assert "4 of 4 simulations have no value: 4 step_limit" in result.stderr
        assert ("failed_fraction of the configuration allows 0.1" in result.stderr) == bool(code)
        table = xr.load_dataset(tmp_path / "hysteresis.nc")
        assert set(table["status_sentence"].values.flat) == {Status.STEP_LIMIT.value}
        assert "4 simulations" in refused("fit", limited, "--output", tmp_path)


def test_missing_input_of_the_later_steps_is_refused(tmp_path):
    output = ("--output", tmp_path)
    assert "8 of 8 simulations are in no finished shard" in refused("aggregate", TEST, *output)
    assert "lacks hysteresis.nc; run crackfront aggregate" in refused("fit", TEST, *output)


def commands_of_help():
    """Every example in the help of a command, continued lines joined, with the command's name."""
    for name, command in main.commands.items():
        text = (command.epilog or "").split("Examples:\n")[-1].replace("\\\n", " ")
        for line in text.splitlines():
            yield name, line.split("#")[0].strip()


def test_every_command_is_listed_and_shows_examples_of_itself():
    text = run("--help").output
    shown = list(commands_of_help())
    for name in main.commands:
        assert f"\n  {name} " in text
        assert "Examples:" in run(name, "--help").output
        assert any(
            f"crackfront {name} " in f"{line} " for command, line in shown if command == name
        )


def test_the_job_script_calls_commands_that_exist():
    script = (ROOT / "workflow/sbatch.sh").read_text(encoding="utf-8")
    called = re.findall(r"^(?:srun .*)?crackfront (\w+)", script, re.MULTILINE)
    assert called == ["simulate", "aggregate", "fit", "checksums"]
    assert set(called) <= main.commands.keys()


@pytest.mark.parametrize(("name", "line"), list(commands_of_help()))
def test_the_examples_of_the_help_name_options_that_exist(name, line):
    words = shlex.split(line.replace("$(", " ").replace(")", " "))
    named_options = {word for word in words if word.startswith("--")}
    defined_options = {option for item in main.commands[name].params for option in item.opts}
    assert named_options <= defined_options


def test_the_plan_names_the_amplitudes_of_the_fit_where_it_leaves_some_out(tmp_path):
    configuration = tmp_path / "few.yaml"
    configuration.write_text(TEST.read_text().replace("[0.02, 0.1]", "[0.02, 0.05, 0.1]"))
    every = run("plan", configuration).stdout
    assert "the fit of k takes all" in every
    copied = configuration.read_text().replace(
        "lowest_elastic_energy: 0.02", "lowest_elastic_energy: 0.05"
    )
    configuration.write_text(copied)
    assert (
        "the fit of k takes 2 of 3 amplitudes: 0.05, 0.1 (fit:" in run("plan", configuration).stdout
    )
    fitted = json.loads(run("plan", configuration, "--json").stdout)["fitted_elastic_energies"]
    assert fitted == [0.05, 0.1]


@pytest.mark.usefixtures("empty_pictures")
def test_machines_read_the_plan_the_progress_and_the_fit(tmp_path, copy_store):
    output = ("--output", tmp_path, "--json")
    before = json.loads(run("plan", TEST, *output).stdout)
    assert (before["simulations"], before["missing"], before["shards"]) == (8, 8, ["flat", "rough"])
    assert before["core_seconds"] > before["longest_seconds"] > 0
    for spectrum in ("flat", "rough"):
        copy_store(spectrum, tmp_path)
    for command in ("simulate", "aggregate"):
        assert run(command, TEST, *output[:2]).exit_code == 0
    after = json.loads(run("plan", TEST, *output).stdout)
    assert (after["missing"], after["core_seconds"]) == (0, 0)
    assert [re.match(r"\w+ has g", entry)[0] for entry in after["warnings"]] == [
        "flat has g",
        "rough has g",
    ]
    status = json.loads(run("status", tmp_path, "--json").stdout)
    assert status["reasons_to_run_again"] == []
    spectra = status["spectra"]
    assert [(entry["name"], entry["done"], entry["left"]) for entry in spectra] == [
        ("flat", 4, 0),
        ("rough", 4, 0),
    ]
    told = json.loads(run("fit", TEST, *output).stdout)
    assert told == json.loads((tmp_path / "fit.json").read_text())


def test_machines_read_how_a_cycle_ended(smooth_tile, tmp_path):
    told = json.loads(cycle(smooth_tile, tmp_path, "--json").stdout)
    dataset = xr.load_dataset(tmp_path / "out.nc")
    assert told == {
        "output": str(tmp_path / "out.nc"),
        "states": dataset.sizes["step"],
        "status": "lost_contact",
        "end_penetration": dataset.attrs["end_penetration"],
        "lowest_force": float(dataset["force"].min()),
        "jump_in_force": float(dataset["force"][0]),
        **dict.fromkeys(("w_appr", "w_retr", "hysteresis")),
    }


def test_a_cycle_tells_in_a_line_what_it_found_and_draws_it(rough_surface, tmp_path, monkeypatch):
    monkeypatch.setattr("crackfront.sweep.watching._SECONDS_IN_LOG", 0.0)
    result = cycle(rough_surface, tmp_path, "--figure", tmp_path / "pictures/loop", step=0.02)
    assert result.exit_code == 0, result.output
    written_cycle = xr.load_dataset(tmp_path / "out.nc")
    assert "state 2, approach: " in result.stderr
    count, pdf, png, told, lost = result.stdout.splitlines()
    assert count == f"{written_cycle.sizes['step']} states: {tmp_path / 'out.nc'}"
    assert [pdf, png] == [f"figure: {tmp_path / 'pictures/loop'}.{kind}" for kind in ("pdf", "png")]
    assert (tmp_path / "pictures/loop.png").stat().st_size > 10_000
    numbers = re.fullmatch(
        r"w_appr (\S+) ± \S+, w_retr (\S+) ± \S+, hysteresis (\S+) ± \S+ \(w_int\); "
        r"jump-in force (\S+), pull-off force (\S+) \(pi w_int R\)",
        told,
    )
    measures = [float(written_cycle[name]) for name in ("w_appr", "w_retr", "hysteresis")]
    measures += [float(written_cycle.force[0]), float(written_cycle.force.min())]
    assert list(map(float, numbers.groups())) == pytest.approx(measures, rel=0.02)
    assert written_cycle.attrs["result"] == told
    assert lost.startswith("contact was lost at penetration")
    assert float(written_cycle.e_el) == pytest.approx(0.05, rel=0.3)


def stopped_cycle(monkeypatch, *arguments):
    """Result of a cycle that is told to end at its seventh state."""

    def interrupted(recorder):
        if len(recorder.states) == 7:
            signal.raise_signal(signal.SIGTERM)

    with monkeypatch.context() as patched:
        shown = nullcontext(interrupted)
        patched.setattr(
            sys.modules["crackfront.cli.cycle_command"], "cycle_progress", lambda *_, **__: shown
        )
        return cycle(*arguments)


@pytest.mark.usefixtures("_heeded_signals")
def test_a_cycle_that_is_told_to_end_goes_on_to_the_same_bits(rough_surface, tmp_path, monkeypatch):
    options = ("--record", "fronts", "--record", "energy")
    whole = cycle(rough_surface, tmp_path, *options)
    assert whole.exit_code == 0
    undisturbed = xr.load_dataset(tmp_path / "out.nc")

    stopped = stopped_cycle(monkeypatch, rough_surface, tmp_path, *options)
    assert stopped.exit_code == StoppedError.exit_code
    kept = tmp_path / "out.checkpoint.nc"
    [told] = stopped.stderr.splitlines()
    for words in ("7 states", str(kept), "the same command"):
        assert words in told
    again = cycle(rough_surface, tmp_path, *options)
    assert again.exit_code == 0
    assert f"going on from {kept}, after state 7" in again.stderr
    assert again.stdout == whole.stdout
    assert not kept.exists()
    xr.testing.assert_equal(xr.load_dataset(tmp_path / "out.nc"), undisturbed)


@pytest.fixture
def kept_states(rough_surface, tmp_path, monkeypatch, _heeded_signals):
    """States that a cycle has kept."""
    stopped_cycle(monkeypatch, rough_surface, tmp_path)
    return tmp_path / "out.checkpoint.nc"


def test_what_another_cycle_kept_is_never_lost(rough_surface, kept_states, tmp_path):
    before = kept_states.read_bytes()
    result = cycle(rough_surface, tmp_path, step=0.2)
    assert result.exit_code == 2
    assert f"{kept_states} has the states of another cycle" in result.stderr
    assert kept_states.read_bytes() == before
    assert cycle(rough_surface, tmp_path).exit_code == 0


@pytest.mark.parametrize(
    ("output", "figure", "sentence"),
    [
        ("a.checkpoint.nc", "b.svg", "--output would overwrite"),
        ("b.nc", "a.checkpoint.nc", "--figure would overwrite"),
        ("a.nc", "b.svg", "the checkpoint would overwrite"),
        ("b.svg", "b.svg", "--output and --figure are the same file"),
        ("scan.al3d", "b.svg", "that crackfront has not written"),
    ],
)
def test_a_cycle_overwrites_nothing_that_it_has_not_written(
    rough_surface, tmp_path, output, figure, sentence
):
    field = Path(shutil.copy(rough_surface, tmp_path / "a.checkpoint.nc"))
    (tmp_path / "scan.al3d").write_text("a scan")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    told = ("cycle", "--field", field, "--max-penetration", 0.5, "--step", 0.5)
    named = ("--output", tmp_path / output, "--figure", tmp_path / figure)
    assert sentence in refused(*told, *named)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_loads_in_a_list_may_have_blanks_and_must_be_numbers(rough_surface, tmp_path):
    arguments = ("cycle", "--field", rough_surface, "--output", tmp_path / "o.nc", "--step", 0.5)
    assert "; jump-in force " in run(*arguments, "--loads", "0, 0.5, 0").stdout
    assert "; first force " in run(*arguments, "--loads", "0.5, 0").stdout
    assert xr.load_dataset(tmp_path / "o.nc").penetration.values.max() == 0.5
    assert "a load is ''; write numbers alone" in refused(*arguments, "--loads", "0,,0.5")
    picture = tmp_path / "loads.png"
    picture.write_bytes(b"\x89PNG")
    assert "which is not a text" in refused(*arguments, "--loads", picture)


@pytest.mark.parametrize("harm", ["a flipped bit", "something else"])
def test_damaged_states_of_a_cycle_are_told_and_set_aside(
    rough_surface, kept_states, tmp_path, harm
):
    content = kept_states.read_bytes()
    middle = content.index(xr.load_dataset(kept_states)["force"].values.tobytes())
    harmed = {
        "a flipped bit": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        "something else": b"something else",
    }[harm]
    kept_states.write_bytes(harmed)
    result = cycle(rough_surface, tmp_path)
    assert result.exit_code == 0
    [told] = result.stderr.splitlines()
    assert f"{kept_states} is damaged" in told
    assert "out.checkpoint.nc.damaged" in told
    assert not kept_states.exists()
    assert (tmp_path / "out.checkpoint.nc.damaged").read_bytes() == harmed


@pytest.mark.usefixtures("_heeded_signals")
@pytest.mark.parametrize("signal_number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_any_command_that_is_told_to_end_says_so_with_the_same_exit_code(
    monkeypatch, signal_number
):
    def interrupted(**options):
        signal.raise_signal(signal_number)

    monkeypatch.setattr(main.commands["law"], "callback", interrupted)
    result = run("law")
    assert result.exit_code == StoppedError.exit_code
    assert result.stderr.startswith("Interrupted. No file is incomplete; run the same command")
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@pytest.mark.slow
def test_the_library_changes_no_setting_of_the_program_that_imports_it():
    code = """
import signal, sys
def settings():
    handlers = [signal.getsignal(number) for number in signal.valid_signals()]
    return handlers, sys.meta_path[:]
before = settings()
import crackfront as cf
[getattr(cf, name) for name in cf.__all__]
import crackfront.cli, crackfront.sweep.tasks, crackfront.sweep.integrity
assert settings() == before
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=600)


@pytest.mark.slow
def test_a_scan_becomes_a_field_in_a_process_of_its_own(tmp_path, monkeypatch):
    measure_surfaces_once(monkeypatch)
    sphere = "--modulus 0.7N/mm2 --poisson 0.5 --radius 20um --work-of-adhesion 63mJ/m2"
    arguments = ["surface", str(DETAIL), *sphere.split()]
    alone, within = tmp_path / "alone.nc", tmp_path / "within.nc"
    command = [sys.executable, "-m", "crackfront", *arguments, "--field", str(alone)]
    subprocess.run(command, check=True, timeout=600)
    assert run(*arguments, "--field", within).exit_code == 0
    assert xr.load_dataset(alone).equals(xr.load_dataset(within))


def test_an_output_that_cannot_be_written_is_refused_with_its_path(tmp_path):
    obstacle = tmp_path / "file"
    obstacle.write_text("no folder")
    sentence = refused("simulate", TEST, "--output", obstacle / "results")
    assert str(obstacle) in sentence
    assert "cannot be used: Not a directory; check the path and its permissions" in sentence


@pytest.mark.parametrize(
    "command",
    [
        "cycle --max-penetration 0.3 --step 0.1 --output out.nc --field",
        "surface --unit m --size 1,1",
        "predict --modulus 1MPa --poisson 0.5 --radius 1mm --work-of-adhesion 1mJ/m2",
        "loop --radius 1mm",
        "samples",
        "plan",
        "archive",
        "verify",
    ],
)
def test_a_link_to_itself_is_refused_in_a_sentence(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    Path("loop.nc").symlink_to("loop.nc")
    assert "loop.nc" in refused(*command.split(), "loop.nc")


@pytest.mark.parametrize(
    ("output", "reason"),
    [
        ("/dev/null", "it is a device or pipe, which is not replaced"),
        ("/proc/none/cycle.nc", "No such file or directory"),
        (".", "Is a directory"),
    ],
)
def test_a_cycle_that_could_not_be_written_is_not_computed(
    smooth_tile, monkeypatch, output, reason
):
    monkeypatch.setattr("crackfront.surfaces.surface_array.read_field", None)
    options = ("--field", smooth_tile, "--max-penetration", "0.5")
    assert f"cannot be used: {reason}" in refused("cycle", *options, "--output", output)


def test_a_full_disk_is_told_as_that_whatever_netcdf_says(smooth_tile, tmp_path, monkeypatch):
    def write(*_, **__):
        raise AttributeError("'NoneType' object has no attribute 'pos'")

    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(xr.Dataset, "to_netcdf", write)
    module = sys.modules["crackfront.cli.cycle_command"]
    monkeypatch.setattr(module, "check_writable", lambda folder: None)
    monkeypatch.setattr("crackfront.simulate.storage.tempfile.TemporaryFile", full)
    options = ("--field", smooth_tile, "--max-penetration", "0.1", "--step", "0.1")
    sentence = refused("cycle", *options, "--output", tmp_path / "cycle.nc")
    told = f"{tmp_path / 'cycle.nc'} cannot be written: No space left on device; make room and rep"
    assert told in sentence


CYCLES = """
import shlex, sys
from crackfront.cli import main
for loads in sys.argv[3:]:
    words = ["cycle", "--field", sys.argv[1], "--output", sys.argv[2], *shlex.split(loads)]
    main(words, standalone_mode=False)
"""


@pytest.mark.slow
def test_once_the_solver_is_compiled_ahead_no_run_compiles_it(smooth_tile, tmp_path):
    assert run("compile").exit_code == 0
    sphere = "--max-penetration 0.1 --step 0.1"
    line = "--spring 1 --loads 0,1,0 --step 1"
    command = [sys.executable, "-c", CYCLES, smooth_tile, tmp_path / "out.nc", sphere, line]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600)
    assert done.stdout.count(f"states: {tmp_path / 'out.nc'}") == 2
    assert "compiling" not in done.stdout + done.stderr


def test_a_defect_of_a_solver_is_one_sentence():
    def broken():
        raise DefectError("the solver moved past its equilibrium; please report it")

    commands = Commands(commands=[click.Command("broken", callback=broken)])
    result = CliRunner().invoke(commands, ["broken"])
    assert result.exit_code == 1
    assert result.stderr == "Error: the solver moved past its equilibrium; please report it\n"
