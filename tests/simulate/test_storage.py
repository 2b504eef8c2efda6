"""Files: what is written is read back, what is broken is refused, nothing is written by half."""

import errno
import fcntl
import json
import math
import os
import re
import shutil
import subprocess
import sys
from dataclasses import asdict, fields, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crackfront.analysis.steady_adhesion import STEADY_DEFINITION
from crackfront.analysis.sweep_fit import fit_sweep
from crackfront.analysis.table import SweepAxes, SweepRow
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState, sphere
from crackfront.core.outcome import Status
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import variables
from crackfront.simulate.cycle_files import cycle_dataset, cycle_record
from crackfront.simulate.numerical_errors import numerical_error
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.storage import (
    FileSystemError,
    UnreadableFileError,
    read_dataset,
    write_dataset,
    write_derived,
)
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.surfaces.surface_array import read_field
from crackfront.sweep.curves import FinishedSimulation, curves_dataset, read_result, write_curves
from crackfront.sweep.fit_files import write_fit
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import row_columns, sweep_row
from crackfront.sweep.table_file import columns_dataset, read_statuses, read_table

SWEEP = load_sweep(Path(__file__).parents[2] / "config/test.yaml")
ORIGIN = Provenance("1.2.3", "abc", "crackfront test", "seed: 1\n")


@pytest.fixture(scope="module")
def result():
    """Result of one small simulation with everything recorded."""
    simulation = SWEEP.simulation(SWEEP.spectra[0], 0.1, 0)
    small = replace(simulation.resolution, n_angle=32)
    return run_simulation(
        replace(simulation, resolution=small, record_fronts=True, record_energy=True)
    )


def finished(result):
    """A result as a rank returns it."""
    return FinishedSimulation(result.simulation, sweep_row(result), result.record, "processor")


def assert_same(record: CycleRecord, expected: CycleRecord):
    """Two records agree in every bit."""
    np.testing.assert_equal(asdict(record), asdict(expected))


def without_states(record: CycleRecord, status: Status):
    """A record that ended before its first state."""
    empty = {name: values[:0] for name, values in asdict(record.states).items()}
    return CycleRecord(
        status=status,
        end_load=0.0,
        states=ContactState(**empty),
        dissipated_energy=None if record.fronts is None else record.dissipated_energy[:0],
        fronts=None if record.fronts is None else record.fronts[:0],
    )


def test_a_cycle_without_states_is_read_back(tmp_path, result):
    record = without_states(result.record, Status.STEP_LIMIT)
    write_dataset(tmp_path / "cycle.nc", cycle_dataset(record, sphere(32)), ORIGIN)
    assert_same(cycle_record(read_dataset(tmp_path / "cycle.nc")), record)


def assert_follows_cf(dataset):
    """A file has what the CF conventions want, with units that udunits knows."""
    assert dataset.Conventions == "CF-1.11"
    assert dataset.history == f"{dataset.date}: crackfront test"
    assert dataset.title
    for name, values in dataset.variables.items():
        assert values.attrs["units"] in ("1", "rad", "s", "byte"), name
        assert values.attrs["long_name"], name


def test_a_file_of_curves_says_what_it_has_in_which_units_and_of_which_simulations(
    tmp_path, result
):
    path = write_curves(tmp_path, "curves", "flat", curves_dataset([finished(result)]), ORIGIN)
    dataset = xr.load_dataset(path)
    assert_follows_cf(dataset)
    assert dataset.force.attrs["reduced_unit"] == "pi w_int R"
    labels = [dataset[name].item() for name in ("spectrum", "elastic_energy", "realisation")]
    assert labels == ["flat", 0.1, 0]
    assert dataset["seed"].item() == result.simulation.seed
    [front] = (dataset[name] for name in dataset.data_vars if name == "front")
    assert front.sizes["front_site"] == 32 * dataset.sizes["state"]


def test_every_file_says_where_it_comes_from(tmp_path, result):
    write_dataset(tmp_path / "cycle.nc", cycle_dataset(result.record, sphere(32)), ORIGIN)
    attributes = xr.load_dataset(tmp_path / "cycle.nc").attrs
    for item in fields(Provenance):
        assert attributes[item.name] == getattr(ORIGIN, item.name)
    assert attributes["date"].endswith("+00:00")
    assert attributes["status"] == "lost_contact"
    assert attributes["status_sentence"] == Status.LOST_CONTACT.value


def test_simulations_are_read_back_with_their_costs(tmp_path, result):
    plain = replace(result, record=replace(result.record, fronts=None))
    written = [plain, result]
    dataset = curves_dataset([finished(source) for source in written])
    path = write_curves(tmp_path, "curves", "flat", dataset, ORIGIN)
    for place, expected in enumerate(written):
        again = read_result(path, place, expected.simulation)
        assert_same(again.record, expected.record)
        assert again.measures == expected.measures


def test_a_file_of_something_else_is_refused(tmp_path):
    write_derived(tmp_path / "a.nc", xr.Dataset({"a": ("x", [1.0])}), ORIGIN)
    with pytest.raises(UnreadableFileError, match="is not a loop: it lacks penetration"):
        cycle_record(read_dataset(tmp_path / "a.nc"))
    with pytest.raises(UnreadableFileError, match=r"a.nc lacks .*spectrum"):
        read_table(tmp_path / "a.nc")
    with pytest.raises(UnreadableFileError, match=r"none.nc does not exist"):
        read_table(tmp_path / "none.nc")


def test_a_failed_write_leaves_the_old_file_and_no_other(tmp_path, result, monkeypatch):
    path = tmp_path / "cycle.nc"
    write_dataset(path, cycle_dataset(result.record, sphere(32)), ORIGIN)
    before = path.read_bytes()

    def fail(*args, **options):
        Path(args[1]).write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    with pytest.raises(OSError, match="no space"):
        write_dataset(path, cycle_dataset(result.record, sphere(32)), ORIGIN)
    assert path.read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == ["cycle.nc"]


# Fields


def tile(n_x=4, n_y=6, spacing=0.5):
    """A tile whose values tell their place."""
    values = 10.0 * np.arange(n_x)[:, None] + np.arange(n_y)[None, :] + 1
    return xr.DataArray(
        WORK_OF_ADHESION * values / max(values.mean(), 1.0),
        dims=("x", "y"),
        coords={"x": 2.0 + spacing * np.arange(n_x), "y": spacing * np.arange(n_y)},
        name="work_of_adhesion",
    )


def read_back(tmp_path, array):
    """Field that is read from the file of an array."""
    array.to_dataset().to_netcdf(tmp_path / "F.nc")
    return surface_adhesion(read_field(tmp_path / "F.nc"))


@pytest.mark.parametrize("order", [("x", "y"), ("y", "x")])
def test_a_tile_is_read_by_the_names_of_its_dimensions(tmp_path, order):
    field = read_back(tmp_path, tile().transpose(*order))
    assert isinstance(field, AdhesionMap)
    assert np.array_equal(field.work_of_adhesion, tile().values)
    assert field.pixel == 0.5
    assert field.w_rms == pytest.approx(np.std(tile().values) / WORK_OF_ADHESION)


UNUSABLE = {
    "text": (tile().astype(str), "work_of_adhesion is <U"),
    "oblong pixels": (
        tile().assign_coords(y=0.4 * np.arange(6)),
        "the spacing is 0.5 in x and 0.4 in y; they must be equal",
    ),
    "falling": (tile()[::-1], "x advances by -0.5 to -0.5; it must increase in equal steps"),
}


@pytest.mark.parametrize("case", UNUSABLE)
def test_an_unusable_field_is_refused_with_a_sentence(tmp_path, case):
    array, sentence = UNUSABLE[case]
    with pytest.raises(ValueError, match=re.escape(sentence)):
        read_back(tmp_path, array)


def test_a_file_with_two_surfaces_is_refused(tmp_path):
    xr.Dataset({"height": tile(), "work_of_adhesion": tile()}).to_netcdf(tmp_path / "F.nc")
    with pytest.raises(ValueError, match="has both height and work_of_adhesion; keep one"):
        read_field(tmp_path / "F.nc")


# The file of a sweep


@pytest.fixture(scope="module")
def results():
    """Results of the whole sweep; one of them failed, and one has no steady part."""
    outcomes = {}
    for simulation in SWEEP.simulations():
        outcomes[simulation.spectrum_name, simulation.elastic_energy, simulation.realisation] = (
            run_simulation(simulation)
        )
    failed = outcomes["flat", 0.02, 1]
    outcomes["flat", 0.02, 1] = replace(
        failed, record=without_states(failed.record, Status.STEP_LIMIT)
    )
    still = outcomes["rough", 0.1, 0]
    travel = np.zeros_like(still.record.states.least_travel)
    outcomes["rough", 0.1, 0] = replace(
        still,
        record=replace(still.record, states=replace(still.record.states, least_travel=travel)),
    )
    return outcomes


@pytest.fixture
def hysteresis(tmp_path, results):
    """File of the sweep."""
    path = tmp_path / "hysteresis.nc"
    rows = [sweep_row(outcome) for outcome in results.values()]
    columns = row_columns(rows, (2, 2, 2))
    write_derived(path, columns_dataset(SWEEP, columns, range(2)), ORIGIN)
    return path


def test_the_file_of_a_sweep_has_everything_under_its_labels(hysteresis, results):
    dataset = xr.load_dataset(hysteresis)
    assert read_statuses(hysteresis) == {"lost_contact": 6, "step_limit": 1, "no_steady_part": 1}
    assert dataset["hysteresis"].dims == ("spectrum", "amplitude", "realisation")
    assert dataset.attrs["definition"] == STEADY_DEFINITION
    for place, result in results.items():
        cell = dataset.sel(spectrum=place[0], amplitude=place[1], realisation=place[2])
        assert cell["e_el"] == result.measures.e_el
        assert cell["w_rms"] == result.measures.w_rms
        assert cell["seed"] == result.simulation.seed
        assert cell["max_sweeps"] == result.simulation.solver.max_sweeps
        assert cell["iterations"] == np.sum(result.record.states.iterations)
    assert np.array_equal(dataset["hurst"], [1.0, 0.8])
    assert dataset["w_rms_requested"].values == pytest.approx(2 * np.sqrt(SWEEP.elastic_energies))
    expected = {item.name for kind in (SweepAxes, SweepRow) for item in variables(kind)}
    assert set(dataset.variables) == expected - {"parameters"}
    assert_follows_cf(dataset)
    words = dataset.status.flag_meanings.split()
    assert dataset.status.flag_values.tolist() == [*range(len(words))]


def test_the_table_of_a_sweep_is_rearranged_before_it_is_loaded(hysteresis):
    loaded = xr.load_dataset(hysteresis)
    with xr.open_dataset(hysteresis) as lazy:
        for arrange in (
            lambda table: table.transpose("realisation", ...),
            lambda table: table.stack(simulation=("spectrum", "amplitude", "realisation")),
            lambda table: table.isel(amplitude=-1).transpose(),
            lambda table: table.transpose("realisation", ...).hysteresis.mean("realisation"),
        ):
            assert arrange(lazy).identical(arrange(loaded))


def test_every_value_states_its_statistical_and_its_numerical_error(hysteresis, results):
    dataset = xr.load_dataset(hysteresis)
    is_finite = np.isfinite(dataset["w_appr"].values)
    for branch in ("w_appr", "w_retr"):
        for name in (f"{branch}_error", f"{branch}_numerical_error"):
            assert np.array_equal(np.isfinite(dataset[name].values), is_finite)
            assert np.all(dataset[name].values[is_finite] > 0)
    cell = dataset.sel(spectrum="flat", amplitude=0.1, realisation=0)
    simulation = results["flat", 0.1, 0].simulation
    # Nearer states count as one: the error lies between those of one and of all states.
    cutoffs = math.pi * float(cell["lowest_radius"] + cell["highest_radius"]) / 0.1
    few, many_states = (
        numerical_error(simulation, count * cutoffs, 2 * math.pi * float(cell["highest_radius"]))
        for count in (1, int(cell["n_approach"]))
    )
    assert many_states[0] <= cell["w_appr_numerical_error"] <= few[0]


def test_a_fit_is_written_for_machines_and_for_people(tmp_path, hysteresis):
    ends = {"lowest_elastic_energy": 0.02, "highest_elastic_energy": 0.1}
    fit = fit_sweep(read_table(hysteresis), **ends, n_bootstrap=200)
    netcdf, plain, text = write_fit(tmp_path / "fit", fit, "table", ORIGIN)
    dataset = xr.load_dataset(netcdf)
    content = json.loads(plain.read_text(encoding="utf-8"))
    assert_follows_cf(dataset)
    assert dataset.factor.dims == ("spectrum", "bound")
    errors = dataset.factor.sel(bound="standard_error").values.tolist()
    assert errors == fit.spectra.factor.standard_error.tolist()
    assert errors == [row[1] for row in content["columns"]["factor"]["values"]]
    assert content["about"]["lowest_elastic_energy"] == 0.02
    assert set(content["columns"]) == set(dataset.variables)
    assert "pooled" in text.read_text(encoding="utf-8")
    assert dataset.attrs["git_commit"] == content["origin"]["git_commit"] == "abc"


@pytest.mark.parametrize(
    ("number", "sentence"),
    [
        (errno.ENOLCK, "cannot be locked: No locks available; set HDF5_USE_FILE_LOCKING=FALSE"),
        (errno.ENOSYS, "cannot be locked: Function not implemented; set HDF5_USE_FILE_LOCKING"),
        (errno.EOPNOTSUPP, "cannot be locked: Operation not supported; set HDF5_USE_FILE_LOC"),
        (errno.EWOULDBLOCK, "is locked by another process that writes it; wait until"),
    ],
)
def test_what_the_file_system_cannot_lock_is_no_damage(tmp_path, monkeypatch, number, sentence):
    def refused(*arguments):
        raise OSError(number, os.strerror(number))

    path = tmp_path / "file.nc"
    path.write_bytes(b"what HDF5 does not open")
    monkeypatch.setattr(fcntl, "flock", refused)
    monkeypatch.setenv("HDF5_USE_FILE_LOCKING", "TRUE")
    with pytest.raises(FileSystemError, match=re.escape(f"{path} {sentence}")):
        read_dataset(path)
    monkeypatch.setenv("HDF5_USE_FILE_LOCKING", "FALSE")
    with pytest.raises(UnreadableFileError, match="is not a complete netCDF file"):
        read_dataset(path)


NO_LOCKS = """
#include <errno.h>
int flock(int number, int operation) { errno = ENOLCK; return -1; }
"""

READ = """
import sys
from pathlib import Path
from crackfront.simulate.storage import read_attributes, read_dataset
for read in (read_dataset, read_attributes):
    try:
        print(read(Path(sys.argv[1])))
    except OSError as error:
        print(error)
"""


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a compiler of C")
def test_files_are_whole_where_locks_are_absent(tmp_path):
    source, library = tmp_path / "locks.c", tmp_path / "locks.so"
    source.write_text(NO_LOCKS)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)
    folder = tmp_path / "results"
    write_dataset(folder / "file.nc", xr.Dataset({"a": 1.0}), Provenance(*"abcd"))
    environment = os.environ | {"LD_PRELOAD": str(library)}
    environment.pop("HDF5_USE_FILE_LOCKING", None)

    def output(*arguments):
        done = subprocess.run(
            [sys.executable, *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            env=environment,
        )
        return done.stdout + done.stderr

    told = output("-c", READ, folder / "file.nc")
    remedy = "cannot be locked: No locks available; set HDF5_USE_FILE_LOCKING=FALSE in the envi"
    assert told.count(remedy) == 2
