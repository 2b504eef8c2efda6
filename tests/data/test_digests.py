"""Digests: whatever bit of a file is flipped, no reader believes it, and none ends otherwise."""

import hashlib
from contextlib import contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

import crackfront as cf
from crackfront.analysis.sweep import fit_sweep
from crackfront.cli import main
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.solver.relax import SOLVERS
from crackfront.data.digests import Integrity, integrity, seal
from crackfront.data.files import (
    UnreadableFileError,
    read_attributes,
    read_dataset,
    refuse_damaged,
    write_dataset,
)
from crackfront.data.provenance import provenance
from crackfront.data.records import read_record, write_record
from crackfront.plots.style import blank_figure, save_figure
from crackfront.simulate.files import cycle_dataset, cycle_record, read_checkpoint, write_checkpoint
from crackfront.simulate.run import run_simulation
from crackfront.simulate.user_surface import read_field, surface_adhesion
from crackfront.sweep import tasks
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.fit_files import write_fit
from crackfront.sweep.store import Store
from crackfront.sweep.table import read_table
from studies.paper.figure import load_figure
from studies.paper.main_1d import FIGURE

ROOT = Path(__file__).parents[2]
SWEEP = load_configuration(ROOT / "config/test.yaml")
ONE = SWEEP.simulation(SWEEP.spectra[0], SWEEP.elastic_energies[0], 0)

NAMES = ("fit.nc", "shards/a.json", "fit.md", "summary.html", "configuration.yaml")
NAMES += ("figures/loop.pdf", "figures/quick/main-1d.png", "figures/quick/film.gif")


@contextmanager
def flipped(path, bit):
    """A file of which one bit is the other for a while."""
    with path.open("rb+", buffering=0) as file:
        file.seek(bit // 8)
        [byte] = file.read(1)
        for value in (byte ^ 1 << bit % 8, byte):
            file.seek(bit // 8)
            file.write(bytes([value]))
            if value != byte:
                yield


def sealed(folder, name):
    """A file of results and its digest."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text('{\n "a": 1\n}\n')
    return path, seal(path, path.suffix)


@pytest.mark.parametrize("stride", [7, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", NAMES)
def test_every_single_bit_of_a_file_of_results_counts(tmp_path, name, stride):
    path, digest = sealed(tmp_path, name)
    assert integrity(path) == (Integrity.WHOLE, digest)
    for bit in range(0, 8 * path.stat().st_size, stride):
        with flipped(path, bit):
            assert integrity(path)[0] is Integrity.DAMAGED, f"bit {bit}"
    assert integrity(path)[0] is Integrity.WHOLE


@pytest.mark.parametrize("name", NAMES)
def test_a_file_of_results_that_is_cut_emptied_or_zeroed_is_damaged(tmp_path, name):
    path, _ = sealed(tmp_path, name)
    content = path.read_bytes()
    cut = [content[:length] for length in range(len(content))]
    for left in (*cut, bytes(len(content)), content + b" "):
        path.write_bytes(left)
        assert integrity(path)[0] is Integrity.DAMAGED


def test_a_file_of_the_users_own_needs_no_digest(tmp_path):
    for name in ("notes.md", "curves/field.nc", "figures.pdf", "mine.yaml"):
        path, _ = sealed(tmp_path, name)
        path.write_text("text")
        assert integrity(path)[0] is Integrity.UNKNOWN


def test_the_digest_is_the_checksum_of_everything_else(tmp_path):
    path = tmp_path / "file.md"
    path.write_text("# Title\n")
    digest = seal(path, ".md")
    text = path.read_text()
    assert text == f"# Title\n<!-- crackfront digest sha256 {digest} -->\n"
    assert hashlib.sha256(text.replace(digest, "").encode()).hexdigest() == digest


@pytest.fixture(scope="module")
def kinds(tmp_path_factory):
    """A file of every kind that is written and read later, each with its reader."""
    folder = tmp_path_factory.mktemp("kinds")
    store = Store(folder / "sweep")
    origin = provenance("text")
    [shard, *_] = SWEEP.shards()
    list(tasks.fill(store, list(SWEEP.simulations()), origin))
    store.write_manifest(SWEEP, shard)
    store.aggregate(SWEEP, origin)
    ends = {"lowest_elastic_energy": 0.02, "highest_elastic_energy": 0.1}
    fitted = fit_sweep(read_table(store.hysteresis), **ends, n_bootstrap=100)
    fits = write_fit(store.folder, fitted, origin)
    kept = []
    run_simulation(ONE, keep=lambda make: kept.append(make()))
    write_checkpoint(folder / "checkpoint.nc", kept[4], origin)
    surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
    cf.save_result(surface, folder / "surface.nc")
    cf.save_result(cf.run_loop(surface, step=0.25), folder / "loop.nc")
    field = contact_field(surface_adhesion(surface), 0.2)
    record = run_cycle(field, LoadSchedule(0.2, 0.1), SOLVERS["newton"](1e-6))
    write_dataset(folder / "cycle.nc", cycle_dataset(record), origin)
    parameters = load_figure(ROOT / "config/figures/main-1d.yaml", "quick")
    smooth = FIGURE.compute(parameters, lambda line: None)
    write_record(folder / "main-1d.nc", smooth, origin)
    pictures = save_figure(blank_figure(1, 1), folder / "picture")
    return {
        "table": (store.hysteresis, read_table),
        "list of a shard": (folder / "sweep/shards/flat.json", refuse_damaged),
        "configuration": (store.configuration, refuse_damaged),
        "fit": (fits[0], read_dataset),
        "fit as JSON": (fits[1], refuse_damaged),
        "fit to read": (fits[2], refuse_damaged),
        "checkpoint": (folder / "checkpoint.nc", lambda path: read_checkpoint(path, ONE)),
        "surface": (folder / "surface.nc", cf.load_result),
        "loop": (folder / "loop.nc", cf.load_result),
        "field": (folder / "surface.nc", read_field),
        "cycle": (folder / "cycle.nc", lambda path: cycle_record(read_dataset(path), path)),
        "figure": (folder / "main-1d.nc", lambda path: read_record(path, FIGURE.record)),
        "provenance": (folder / "main-1d.nc", read_attributes),
        "PDF": (pictures[0], refuse_damaged),
        "PNG": (pictures[1], refuse_damaged),
    }


def believed(path, read, bits):
    """Bits of a file that may be the other without its reader refusing it by its name.

    A file of the user's own has no digest any more where the mark of the digest is damaged.
    """
    read(path)
    found = []
    mark = path.read_bytes().index(b"crackfront digest")
    for bit in bits:
        if mark <= bit // 8 < mark + 25:
            continue
        with flipped(path, bit):
            try:
                read(path)
            except UnreadableFileError as error:
                found += [] if str(path) in str(error) else [bit]
            else:
                found.append(bit)
    return found


@pytest.mark.parametrize("count", [50, pytest.param(500, marks=pytest.mark.slow)])
def test_no_flipped_bit_of_any_kind_of_file_is_believed(kinds, rng, count):
    for path, read in kinds.values():
        bits = rng.integers(8 * path.stat().st_size, size=count)
        assert believed(path, read, bits.tolist()) == []


def test_a_damaged_result_that_a_person_keeps_is_refused_with_one_sentence(kinds, tmp_path):
    path, _ = kinds["surface"]
    options = ["--max-penetration", "0.1", "--output", str(tmp_path / "cycle.nc")]
    with flipped(path, 40000):
        result = CliRunner().invoke(main, ["cycle", "--field", str(path), *options])
    assert result.exit_code == 2
    assert result.output.splitlines() == [
        f"Error: {path} is damaged, its digest is wrong or missing; restore it or write it again"
    ]
