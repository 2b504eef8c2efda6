"""What `import crackfront` offers: surfaces, loops, units and plots, all of them xarray."""

import ast
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot
from matplotlib.figure import Figure

import crackfront as cf
from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core import jkr
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL
from crackfront.simulate.cycle_files import cycle_record
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import simulation_adhesion, simulation_field
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.surfaces.random_surface import chosen_simulation
from crackfront.sweep import parallel, tasks
from tests.commands import run, stored
from tests.places import ROOT, TEST

SCAN = ROOT / "examples/scans/nanodiamond-detail.al3d"
SPHERE = cf.Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)
FLAT = cf.SelfAffineSpectrum(0.4, 0.4, hurst=1.0)
COARSE = {"short_cutoff": 0.4, "elastic_energy": 0.05, "side": 4.0, "error": 0.05, "seed": 3}


@pytest.fixture(autouse=True)
def _no_figures():
    """No figure of pyplot from before, as that of the docstring of the package."""
    pyplot.close("all")


@pytest.fixture(scope="module")
def surface():
    """A coarse rough surface."""
    return cf.random_surface(**COARSE)


@pytest.fixture(scope="module")
def loop(surface):
    """Its loop."""
    return cf.run_loop(surface, step=0.05, error=0.05, energy=True)


@pytest.fixture(scope="module")
def jumps(surface):
    """The instabilities of its retraction."""
    return cf.find_instabilities(surface, error=0.05, step=0.1)


def simulation_of(surface, elastic_energy, load):
    """The simulation of the surface, whose numerics follow from what was measured on the tile."""
    numerics = {"error": 0.05, "side": 4.0, "seed": 3}
    requested = chosen_simulation("roughness", FLAT, 0.05, load, **numerics)
    measured = chosen_simulation("roughness", FLAT, elastic_energy, load, **numerics)
    resolution = replace(measured.resolution, n_point=surface.sizes["x"], tile_side=4.0)
    return replace(requested, resolution=resolution, solver=measured.solver, record_fronts=True)


def tile(values, name="height", units=VERTICAL, spacing=0.1):
    """A surface of a user's own."""
    axes = {
        axis: (axis, spacing * np.arange(count), {"units": LATERAL})
        for axis, count in zip("xy", values.shape, strict=True)
    }
    return xr.DataArray(values, axes, ("x", "y"), name, {"units": units})


def axes_of_a_figure():
    """Axes that pyplot knows nothing of."""
    return Figure().add_subplot()


PARTS = (
    ("crackfront", {"xarray", "numba", "scipy"}),
    (
        "crackfront.measured.prediction.prediction",
        {"xarray", "numba", "scipy.optimize", "scipy.stats"},
    ),
    ("studies.paper.figure", {"xarray", "numba", "scipy.optimize", "scipy.stats"}),
    ("crackfront.sweep.feasibility", {"xarray", "scipy.optimize", "scipy.stats"}),
    ("crackfront.sweep.integrity", {"xarray", "netCDF4"}),
)
"""Parts in an order in which none may load what a later one must not."""


def test_help_a_part_and_the_workflow_load_nothing_that_only_their_work_needs():
    lines = ["import sys", "from crackfront.cli import main"]
    lines += ['main(["--help"], standalone_mode=False)']
    lines += ['assert not {"numpy", "scipy", "numba", "xarray", "mpi4py"} & sys.modules.keys()']
    for part, heavy in PARTS:
        heavy = heavy | {"matplotlib", "mpi4py"}
        lines += [f"import {part}", f"assert not {heavy} & sys.modules.keys(), {part!r}"]
    rules = ast.parse((ROOT / "workflow/rules/common.smk").read_text(encoding="utf-8"))
    imports = [node for node in rules.body if isinstance(node, ast.ImportFrom)]
    ours = [
        node for node in imports if str(node.module).partition(".")[0] in {"crackfront", "studies"}
    ]
    assert len(ours) > 5
    heavy = {"xarray", "netCDF4", "matplotlib", "mpi4py", "tqdm"}
    lines += [*map(ast.unparse, ours), f"assert not {heavy} & sys.modules.keys()"]
    subprocess.run([sys.executable, "-c", "\n".join(lines)], check=True, timeout=600, cwd=ROOT)


def test_the_package_offers_the_library_and_its_version():
    typed = ast.parse(Path(cf.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    stated = {alias.asname for node in ast.walk(typed) for alias in getattr(node, "names", ())}
    assert set(cf.__all__) == stated - {None}
    assert set(cf.__all__) <= set(dir(cf))
    for name in cf.__all__:
        assert getattr(cf, name) is not None


@pytest.mark.parametrize(
    "smooth",
    [tile(np.zeros((8, 8))), tile(np.ones((8, 8)), "work_of_adhesion", ADHESION)],
    ids=["heights", "adhesion"],
)
def test_the_loop_of_a_smooth_surface_is_that_of_jkr(smooth):
    result = cf.run_loop(smooth, step=0.25)
    radii = [jkr.equilibrium_radius(penetration) for penetration in result.penetration.values]
    np.testing.assert_allclose(result.mean_radius, radii, rtol=1e-7)
    np.testing.assert_allclose(result.force, jkr.equilibrium_force(np.array(radii)), atol=1e-7)
    assert result.attrs["status"] == "lost_contact"
    assert (float(result.e_el), float(result.w_rms)) == (0, 0)


def test_the_loop_of_a_simulation_is_that_of_the_library_to_round_off(surface, loop):
    simulation = simulation_of(surface, float(loop.e_el), FullCycle(1.0, 0.05))
    record = run_simulation(simulation).record
    # Only the pixel differs, by round-off that fronts enlarge where they are about to jump: the
    # library takes it from the coordinates.
    np.testing.assert_allclose(loop.radius, record.fronts, rtol=1e-7)
    np.testing.assert_allclose(loop.force, record.states.force, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize("kind", ["roughness", "chemical"])
def test_a_random_surface_is_that_of_the_sweep_of_its_seed(kind):
    surface = cf.random_surface(**COARSE, kind=kind, realisation=2)
    simulation = chosen_simulation(
        kind, FLAT, 0.05, FullCycle(1, 1), error=0.05, side=4.0, seed=3, realisation=2
    )
    adhesion = simulation_adhesion(simulation)
    if kind == "chemical":
        np.testing.assert_allclose(
            surface * WORK_OF_ADHESION, adhesion.work_of_adhesion, rtol=1e-15
        )
    else:
        measured = cf.run_loop(surface, step=0.5, error=0.05)
        assert float(measured.e_el) == pytest.approx(adhesion.e_el, rel=1e-12)
        assert float(measured.w_rms) == pytest.approx(adhesion.w_rms, rel=1e-12)


def test_the_measures_of_a_loop_are_those_of_its_curves(loop):
    steady = steady_adhesion(cycle_record(loop), float(loop.correlation_length))
    names = ("w_appr", "w_retr", "hysteresis")
    assert {name: float(loop[name]) for name in names} == pytest.approx(
        {name: getattr(steady, name) for name in names}, nan_ok=True
    )
    assert loop.attrs["steady_sentence"] == steady.sentence


def test_a_loop_with_a_steady_part_tells_its_works_of_adhesion_and_their_errors():
    fine = cf.random_surface(0.1, 0.02, seed=1)
    loop = cf.run_loop(fine, step=0.05, error=0.1, fronts=False)
    assert 0 < float(loop.w_retr_numerical_error) < 0.1
    assert "radius" not in loop
    error = float(loop.w_retr_error)
    digits = 1 - int(np.floor(np.log10(error)))
    assert f"w_retr {float(loop.w_retr):.{digits}f} ± {error:.{digits}f}" in loop.attrs["result"]


def test_the_energies_of_a_loop_sum_up_to_its_work(loop):
    pull_off = loop.attrs["pull_off_energy"]
    b = np.append(loop.penetration, loop.attrs["end_penetration"])
    radius = np.vstack([loop.radius, loop.radius[-1:]])
    # While the penetration changes the front is held.
    held = [
        jkr.force(front, (b_start + b_end) / 2).mean()
        for front, b_start, b_end in zip(radius, b, b[1:], strict=False)
    ]
    work = float(np.sum(held * np.diff(b)))
    assert float(loop.dissipated_energy.sum()) + pull_off == pytest.approx(work, abs=1e-3)


def test_si_units_and_back_change_nothing(surface, loop, jumps):
    for data in (surface, loop, jumps):
        back = cf.in_reduced_units(cf.in_si_units(data, SPHERE), SPHERE)
        xr.testing.assert_allclose(back, data, rtol=1e-13)
        assert set(back.attrs) == set(data.attrs)
        for name, value in data.attrs.items():
            same = value if isinstance(value, str) else pytest.approx(value, rel=1e-13)
            assert back.attrs[name] == same
        assert {name: part.attrs for name, part in back.coords.items()} == {
            name: part.attrs for name, part in data.coords.items()
        }


def test_a_loop_in_si_units_has_forces_in_newtons(loop):
    converted = cf.in_si_units(loop, SPHERE)
    assert converted.force.attrs["units"] == "N"
    np.testing.assert_allclose(converted.force, loop.force * SPHERE.force)
    np.testing.assert_allclose(converted.contact_area, loop.contact_area * SPHERE.lateral**2)
    np.testing.assert_allclose(converted.w_rms, loop.w_rms * 63e-3)
    assert converted.attrs["end_penetration"] == loop.attrs["end_penetration"] * SPHERE.vertical
    assert converted.direction.dtype == loop.direction.dtype


def test_heights_in_nanometres_give_the_loop_of_reduced_ones(surface, loop):
    measured = cf.in_si_units(surface, SPHERE)
    measured = measured.assign_coords(
        {axis: (axis, 1e6 * measured[axis].values, {"units": "um"}) for axis in "xy"}
    )
    measured = (1e9 * measured).assign_attrs(units="nm")
    result = cf.run_loop(cf.in_reduced_units(measured, SPHERE), step=0.05, error=0.05)
    assert float(result.e_el) == pytest.approx(float(loop.e_el), rel=1e-12)
    np.testing.assert_allclose(result.force, loop.force, atol=1e-3)


def test_a_surface_may_come_with_its_dimensions_in_any_order(surface):
    loop, loop_of_transposed = (
        cf.run_loop(heights, step=0.5, error=0.05)
        for heights in (surface, surface.transpose("y", "x"))
    )
    np.testing.assert_array_equal(loop.radius, loop_of_transposed.radius)


def test_instabilities_sweep_what_the_front_travels_and_lose_energy(surface, loop, jumps):
    assert jumps.sizes["instability"] > 3
    assert np.all(jumps.dissipated_energy > 0)
    assert np.all(jumps.after <= jumps.before + 1e-12)
    assert np.all(np.diff(jumps.penetration) < 0)
    swept = 0.5 * (jumps.before**2 - jumps.after**2).sum("angle") * 2 * np.pi / jumps.sizes["angle"]
    np.testing.assert_allclose(jumps.area, swept, rtol=1e-9)
    simulation = simulation_of(surface, float(loop.e_el), FullCycle(1.0, 0.1))
    field, last = simulation_field(simulation), jumps.isel(instability=-1)
    before, after = last.before.values, last.after.values
    expected = dissipated_energy(before, after, float(last.penetration), field)
    assert float(last.dissipated_energy) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"short_cutoff": -1.0}, "short_cutoff is -1.0;"),
        ({"elastic_energy": 1.5}, "elastic_energy is 1.5; it must be less than 1"),
        ({"elastic_energy": 0.5}, "elastic_energy is 0.5; the numerics are known from 0.001 to"),
        ({"roll_off": 9.0}, "the longest waves of the spectrum, of 9, or its e_el is not"),
        ({"roll_off": 0.1}, "roll_off 0.1 is shorter than short_cutoff 0.4"),
        ({"hurst": 0.8}, "hurst is 0.8, but without a roll_off the spectrum is flat"),
        ({"side": 0.1}, "side is 0.1; the tile must fit the longest waves"),
        ({"kind": "rough"}, "kind is 'rough'; it must be 'roughness' or"),
        ({"seed": -1}, "seed is -1; it must be greater"),
    ],
)
def test_a_surface_that_cannot_be_is_refused(changes, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.random_surface(**(COARSE | changes))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            lambda array: array.rename("z"),
            "named 'z'; say what its values are by the name height or",
        ),
        (lambda array: array.rename(None), "named None; say what its values are"),
        (lambda array: array.assign_attrs(units="nm"), "has the units 'nm'; .* in_reduced_units"),
        (lambda array: array.assign_attrs(units=FORCE), "height has the units 'pi w_int R'"),
        (lambda array: array.drop_attrs(), "states no units"),
        (lambda array: array.rename(x="u"), r"dimensions \(u, y\); a tile must have x and y"),
        (lambda array: array.drop_vars("x"), "no coordinate x"),
        (lambda array: array.where(array.x > array.x[0]), "height is nan at x index 0, y index 0"),
        (
            lambda array: array.assign_attrs(short_cutoff=0.8, roll_off=0.8),
            "waves shorter than its",
        ),
        (lambda array: 6 * array, "energy of full conformity is"),
        (lambda array: array[::4, ::4], "but the finest numerics on"),
    ],
)
def test_a_surface_that_cannot_be_used_is_refused(surface, change, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.run_loop(change(surface), error=0.05)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: cf.Scales(None, 1, 1), "radius is None; it must be a number or"),
        (
            lambda: cf.run_loop(np.zeros((4, 4))),
            "surface is a numpy.ndarray; it",
        ),
        (lambda: cf.run_loop(tile(np.zeros((4, 4))), step="1"), "step is '1'; it must be a number"),
        (
            lambda: cf.run_loop(tile(np.zeros((4, 4))), fronts="no"),
            "fronts is 'no'; it must be",
        ),
        (lambda: cf.save_result(3, "three.nc"), "result is 3; it must be a DataArray or"),
        (lambda: cf.random_surface(0.1, 0.1, seed=1.5), "seed is 1.5; it must be a whole number"),
        (lambda: cf.random_surface(0.1, 0.1, seed=True), "seed is True; it must be a whole number"),
        (lambda: cf.surface(np.zeros((4, 4)), 1.0, units=3), "units is 3; it must be a text"),
        (lambda: cf.run_loop(tile(np.zeros((4, 4))), loads=0.5), "loads is 0.5; give the loads"),
        (lambda: cf.run_loop(tile(np.zeros((4, 4))), loads="01"), "loads is '01'; give the loads"),
        (lambda: cf.plot_surface(tile(np.zeros((4, 4))), axes=3), "axes is 3; it must be an Axes"),
        (lambda: cf.read_scan(SCAN, SPHERE, mask=np.ones(3)), "mask is a numpy.ndarray; give a pa"),
        (lambda: cf.in_si_units([1], SPHERE), "data is \\[1\\]; it must be a DataArray"),
        (lambda: cf.plot_loop(tile(np.zeros((4, 4)))), "loop is a xarray.DataArray; it must"),
        (lambda: cf.read_scan(7, SPHERE), "path is 7; it must be the path"),
        (lambda: cf.predict(7, SPHERE), "scans is 7; it must be the path of a file or"),
        (lambda: cf.run_sweep(7), "configuration is 7; it must be the path"),
    ],
)
def test_an_argument_of_another_type_is_refused_with_what_is_wanted(call, sentence):
    with pytest.raises(TypeError, match=sentence):
        call()


WAVE = 0.3 * np.cos(2 * np.pi * np.arange(32) / 8)[:, None] * np.cos(2 * np.pi * np.arange(32) / 16)
LOADS = [0, 0.5, 0.2, 0.5, 0.5, 0]


def test_an_array_is_the_same_surface_in_all_units():
    expected = cf.surface(1 + WAVE, 4.0, kind="chemical", units="w_int")
    for units, values, sphere in (
        ("reduced", WORK_OF_ADHESION * (1 + WAVE), None),
        (None, WORK_OF_ADHESION * (1 + WAVE), None),
        ("mJ/m2", 63 * (1 + WAVE), SPHERE),
        ("w_int", 1 + WAVE, SPHERE),
    ):
        side = 4.0 if sphere is None else f"{1e6 * 4 * SPHERE.lateral!r}um"
        array_surface = cf.surface(values, side, kind="chemical", units=units, sphere=sphere)
        xr.testing.assert_allclose(array_surface, expected, rtol=1e-14)
    nanometres = cf.surface(
        1e9 * SPHERE.vertical * WAVE / 10, 4 * SPHERE.lateral, units="nm", sphere=SPHERE
    )
    xr.testing.assert_allclose(nanometres, cf.surface(WAVE / 10, 4.0), rtol=1e-13)
    downwards = {"x": np.arange(32) / 8, "y": -np.arange(32) / 8}
    picture = xr.DataArray(1 + WAVE, downwards, ("x", "y"), attrs={"units": "w_int"})
    assert cf.surface(picture, side=4.0, kind="chemical").shape == (32, 32)
    labelled = xr.DataArray((1 + WAVE).T, dims=("y", "x"), attrs={"units": "w_int"})
    xr.testing.assert_identical(cf.surface(labelled, 4.0, kind="chemical"), expected)
    in_metres = cf.in_si_units(nanometres, SPHERE)
    again = cf.surface(in_metres, 4 * SPHERE.lateral, sphere=SPHERE)
    xr.testing.assert_allclose(again, nanometres, rtol=1e-12)
    for place in (4 * 1e6 * SPHERE.lateral, 0.0, -4.0):
        with pytest.raises(ValueError, match=r"^side is .*; it must lie between 1e-09 and 1 m"):
            cf.surface(WAVE, place, sphere=SPHERE)
    plain = nanometres.drop_attrs().assign_attrs(units="reduced")
    np.testing.assert_array_equal(
        cf.run_loop(plain, step=0.5).force, cf.run_loop(nanometres, step=0.5).force
    )


@pytest.mark.parametrize(
    ("values", "side", "sentence"),
    [
        (
            1 + WAVE,
            {},
            r"3.142 w_int, .* in reduced units; .* were they in units of w_int\? Then set",
        ),
        ((1 + WAVE) / np.pi, {"units": "w_int"}, "0.3183 w_int, .* were they in reduced units"),
        (WAVE, {"units": "w_int"}, "were they deviations from it"),
        (5 + WAVE, {"units": "w_int"}, "check the values, or take their mean for w_int"),
        (
            1 + WAVE,
            {"units": "mJ/m2"},
            "units is 'mJ/m2', which needs the sphere; give it",
        ),
        ([1.0, 2.0], {}, r"the values have the shape \(2,\); a tile must be"),
        (
            np.ma.masked_array(1 + WAVE, np.arange(1024).reshape(32, 32) == 40),
            {"units": "w_int"},
            "work_of_adhesion is nan at x index 1, y index 8",
        ),
        (
            xr.DataArray(1 + WAVE, attrs={"units": "w_int"}),
            {"units": "reduced"},
            "units is 'reduced', but the array states 'w_int'; leave units out",
        ),
        (
            xr.DataArray(1 + WAVE, {"x": np.arange(32)}, ("x", "y")),
            {"units": "w_int"},
            "side is 4.0, but the coordinate x of the array spans 32",
        ),
        (
            xr.DataArray(1 + WAVE, {"x": np.arange(32) / 8, "y": np.arange(32) ** 2}, ("x", "y")),
            {"units": "w_int"},
            "y advances by 1 to 61; it must increase in equal steps",
        ),
    ],
)
def test_an_array_that_is_no_surface_is_refused_with_the_likely_cause(values, side, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.surface(values, **({"kind": "chemical", "side": 4.0} | side))


@pytest.mark.parametrize("unit", ["um", "m", "reduced"])
def test_a_side_and_the_coordinate_of_an_array_are_compared_in_one_unit(unit):
    places = {"um": 1e-6, "m": 1.0, "reduced": SPHERE.lateral}[unit]
    x = 100e-6 / places * np.arange(32) / 32
    axes = {name: (name, x, {"units": unit}) for name in "xy"}
    values = xr.DataArray(WAVE, axes, ("x", "y"), attrs={"units": "nm"})
    of_text, of_number = (cf.surface(values, side, sphere=SPHERE) for side in ("100um", 100e-6))
    xr.testing.assert_allclose(of_text, of_number, rtol=1e-12)
    for side in ("50um", 50e-6):
        with pytest.raises(ValueError, match=rf"^side is {side}, but .* {unit}; give this side"):
            cf.surface(values, side, sphere=SPHERE)


@pytest.mark.parametrize("straight", [False, True])
def test_loads_are_visited_up_and_down_by_library_and_command_alike(straight, tmp_path):
    patches = cf.surface(1 + WAVE, 4.0, kind="chemical", units="w_int")
    cf.save_result(patches, tmp_path / "patches.nc")
    (tmp_path / "loads.txt").write_text("# up, down, up, hold, down\n0 0.5 0.2\n0.5\n0.5, 0")
    pressed = cf.straight_front(patches, spring=2.0) if straight else patches
    loop = cf.run_loop(pressed, loads=LOADS, step=0.1, energy=True)
    up, down = 0.1 * np.arange(6), [0.4, 0.3, 0.2]
    load = loop["spring_position" if straight else "penetration"]
    np.testing.assert_allclose(load[:13], [*up, *down, 0.3, 0.4, 0.5, 0.5], atol=1e-12)
    assert loop.direction.values[:15].tolist() == [1] * 6 + [-1] * 3 + [1] * 4 + [-1] * 2
    front = loop["position" if straight else "radius"]
    # By no passing, a minor loop ends at the front that it began with, and a hold changes nothing.
    np.testing.assert_allclose(front[11:13], front[[5, 5]], atol=1e-5)
    options = ["--spring", "2"] if straight else []
    command = ["--loads", tmp_path / "loads.txt", "--step", "0.1", "--output", tmp_path / "out.nc"]
    result = run("cycle", "--field", tmp_path / "patches.nc", *options, *command)
    assert result.exit_code == 0, result.output
    written = xr.load_dataset(tmp_path / "out.nc")
    for name in ("direction", load.name, "e_el", "w_rms", "correlation_length"):
        np.testing.assert_array_equal(written[name], loop[name])
    last = "pinning_force" if straight else "force"
    np.testing.assert_array_equal(written[last], loop[last])


def test_a_straight_front_has_the_works_of_adhesion_of_a_period_of_its_tile():
    surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.04, side=4, seed=2)
    loop = cf.run_loop(cf.straight_front(surface, spring=4.0), loads=[0, 12, 0], step=0.25)
    for name, direction in (("w_appr", 1), ("w_retr", -1)):
        period = loop.pinning_force[loop.direction == direction][-16:]
        exact = float(1 - loop.e_el - period.mean())
        assert float(loop[name]) == pytest.approx(exact, abs=1e-5)
    assert float(loop.hysteresis) > 3 * float(loop.hysteresis_error) > 0
    assert f"w_appr {float(loop.w_appr):.3f}" in loop.attrs["result"]
    short = cf.run_loop(cf.straight_front(surface, spring=4.0), loads=[0, 1, 0], step=0.1)
    assert np.isnan(short.hysteresis)
    assert "so load further" in short.attrs["steady_sentence"]


@pytest.mark.parametrize("loads", [(20, 5, 14), (10, -5, 5), (0, 8, 0, 30), (0, 30, 22, 30, 0)])
def test_loads_that_turn_several_times_count_no_place_twice_and_leave_none_out(loads):
    """At weak disorder no front is pinned, whatever part of the tile it passes."""
    surface = cf.random_surface(0.8, 0.01, side=6.4, kind="chemical", seed=3)
    result = cf.run_loop(cf.straight_front(surface, spring=1.0), loads=loads, step=0.1)
    assert abs(float(result.hysteresis)) < 2e-3


@pytest.mark.parametrize(
    ("loads", "sentence"),
    [
        ([-1, 0], "loads begin with -1; a sphere touches at"),
        ([], "no loads; give one or more"),
        ([0, np.nan], "a load is nan; it must lie"),
        (["x"], "a load is 'x'; write numbers"),
    ],
)
def test_loads_that_cannot_be_are_refused(surface, loads, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.run_loop(surface, loads=loads)
    with pytest.raises(ValueError, match="a sphere needs max_penetration or loads; give one"):
        cf.run_loop(surface, loads=[0, 1], max_penetration=1)
    with pytest.raises(ValueError, match="a straight front needs loads"):
        cf.run_loop(cf.straight_front(surface, 1.0))


def test_scales_take_texts_with_units():
    scales = cf.Scales("1.25mm", "63mJ/m2", contact_modulus="0.9333333333333333 MPa")
    assert asdict(scales) == pytest.approx(asdict(SPHERE), rel=1e-12)
    with pytest.raises(ValueError, match=r"0\.0007 Pa, too soft to be solid; was '0.7MPa' meant"):
        cf.Scales("1mm", "63mJ/m2", "0.7mPa")
    with pytest.raises(
        ValueError, match="radius is '1kg', whose unit is not a unit of length; write a number"
    ):
        cf.Scales("1kg", 1, 1)
    with pytest.raises(ValueError, match=r"radius is -1\.0; it must be positive and finite"):
        cf.Scales(-1, 1, 1)


def test_heights_that_do_not_go_on_across_the_edge_are_refused_unless_that_is_meant(surface):
    tilted = (surface + 0.3 * surface.y).rename("height").assign_attrs(surface.attrs)
    with pytest.raises(ValueError, match=r"from one end of y to the other, .* is not periodic"):
        cf.run_loop(tilted)
    bare = tilted.drop_attrs(deep=False).assign_attrs(units=VERTICAL, periodic=1)
    # A tilt has an energy of its own, which would be computed in silence.
    assert float(cf.run_loop(bare, step=0.5).e_el) > 1.5 * 0.05


def test_a_part_of_a_larger_map_is_refused_as_a_tile(rng):
    whole = gaussian_field(FLAT.with_elastic_energy(0.05), 160, 8.0, rng)
    assert cf.plot_surface(tile(whole, spacing=0.05), axes_of_a_figure())
    with pytest.raises(ValueError, match="the tile is not periodic"):
        cf.plot_surface(tile(whole[:80, :80], spacing=0.05))


def test_a_scan_is_a_surface_to_press_on_that_says_what_was_done_to_it():
    small = cf.Scales("20um", "63mJ/m2", SPHERE.contact_modulus)
    scan_surface = cf.read_scan(SCAN, small, shortest="0.4um")
    assert scan_surface.sizes == {"x": 288, "y": 288}
    assert float(scan_surface.x[144]) == 0
    told = scan_surface.attrs
    assert told["source"].startswith(f"{SCAN}, al3d, checksum ")
    assert told["levelling"].startswith("the paraboloid was subtracted")
    assert told["tile"].startswith("the scan mirrored at its edges")
    assert told["waves"].startswith("those shorter than 400 nm were removed")
    assert "is smaller than the contact" in told["notes"]


def test_a_sweep_that_was_stopped_goes_on_to_its_table(tmp_path, monkeypatch):
    asked = []

    def notice():
        asked.append(1)
        return len(asked) > 150

    with monkeypatch.context() as patched:
        patched.setattr(parallel, "stop_is_requested", notice)
        with pytest.raises(KeyboardInterrupt, match="are stored; run the same"):
            cf.run_sweep(TEST, tmp_path, progress=False)
    assert 0 < len(stored(tmp_path)) < 8
    table = cf.run_sweep(TEST, tmp_path, progress=False)
    assert table.w_retr.dims == ("spectrum", "amplitude", "realisation")
    assert bool((table.w_retr > table.w_appr).all())
    xr.testing.assert_identical(table, xr.load_dataset(tmp_path / "hysteresis.nc"))
    assert (tmp_path / "shards/flat.nc").is_file()

    def run_again(*arguments):
        raise AssertionError("nothing is missing")

    monkeypatch.setattr(tasks, "run_simulation", run_again)
    xr.testing.assert_equal(cf.run_sweep(str(TEST), str(tmp_path)), table)


def test_simulations_without_a_value_are_warned_of(tmp_path):
    limited = tmp_path / "limited.yaml"
    text = TEST.read_text().replace("max_sweeps: 100000", "max_sweeps: 2")
    limited.write_text(text.replace("realisations: 2", "realisations: 1"))
    with pytest.warns(UserWarning, match="4 of 4 simulations have no value: 4 step_limit"):
        table = cf.run_sweep(limited, tmp_path / "out", progress=False)
    assert bool(np.isnan(table.w_retr).all())


@pytest.mark.parametrize(
    ("run", "arguments", "sentence"),
    [
        (cf.run_loop, {"solver": "magic"}, "solver is 'magic'; it must be one of newton"),
        (cf.run_loop, {"step": 0.0}, "step is 0.0; it must be greater"),
        (cf.run_loop, {"max_penetration": -1.0}, "max penetration -1.0 never makes contact"),
        (cf.run_loop, {"error": 1e-6}, "error is 1e-06, but the finest numerics"),
        (cf.find_instabilities, {"direction": "retraction"}, "direction is 'retraction'; it must"),
        (cf.find_instabilities, {"precision": 0.01}, "precision is 0.01; .* at most a tenth of"),
        (cf.find_instabilities, {"step": 0}, "step is 0; it must be greater"),
        (cf.find_instabilities, {"travel": 1e-12}, "travel is 1e-12 .* by up to .* of them;"),
        (cf.find_instabilities, {"precision": 2e-3}, "within a precision of 0.002 a front moves"),
    ],
)
def test_a_loop_that_cannot_be_run_is_refused(surface, run, arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        run(surface, **({"error": 0.05} | arguments))


def test_a_smooth_sphere_has_no_instability_before_pull_off():
    assert cf.find_instabilities(cf.surface(np.zeros((16, 16)), 4), step=0.25).instability.size == 0


def test_truth_is_saved_as_a_number_and_what_netcdf_cannot_hold_is_refused(surface, tmp_path):
    with_truth = surface.assign_attrs(periodic=True)
    cf.save_result(with_truth, tmp_path / "surface.nc")
    loaded = cf.load_result(tmp_path / "surface.nc")
    assert loaded.attrs["periodic"] == 1
    np.testing.assert_array_equal(loaded.values, surface.values)
    assert with_truth.attrs["periodic"] is True
    with pytest.raises(TypeError, match="attribute notes is None; give numbers or a text"):
        cf.save_result(surface.assign_attrs(notes=None), tmp_path / "surface.nc")
    with pytest.raises(TypeError, match="path is None; it must be the path"):
        cf.save_result(surface, None)


def test_what_is_in_si_units_already_is_said_so(surface):
    with pytest.raises(ValueError, match=r"in SI units; in_reduced_units\(data, sphere\) converts"):
        cf.in_si_units(cf.in_si_units(surface, SPHERE), SPHERE)
    with pytest.raises(ValueError, match="height states no units; the attribute units must be"):
        cf.in_si_units(surface.drop_attrs(), SPHERE)


@pytest.mark.parametrize(
    ("units", "sentence"),
    [
        ("kg", "'kg', which cannot be converted to m"),
        ("furlongz", "'furlongz', which cannot"),
        (None, "the units None, which cannot"),
    ],
)
def test_units_of_another_quantity_are_refused(surface, units, sentence):
    changed_units = cf.in_si_units(surface, SPHERE).assign_attrs(units=units)
    with pytest.raises(ValueError, match=sentence):
        cf.in_reduced_units(changed_units, SPHERE)


def test_what_was_converted_for_one_sphere_comes_back_for_no_other(surface):
    second_sphere = cf.Scales("2mm", "100mJ/m2", "1MPa")
    with pytest.raises(ValueError, match="converted for another sphere, radius"):
        cf.in_reduced_units(cf.in_si_units(surface, SPHERE), second_sphere)
    same = cf.Scales(*(np.nextafter(value, 1) for value in asdict(SPHERE).values()))
    xr.testing.assert_allclose(cf.in_reduced_units(cf.in_si_units(surface, SPHERE), same), surface)
    with pytest.raises(ValueError, match="in reduced units already; nothing is to be converted"):
        cf.in_reduced_units(surface, SPHERE)


def test_unknown_variables_have_no_units_to_convert(loop):
    with pytest.raises(ValueError, match="spring_position is of a straight front, which touches"):
        cf.in_si_units(loop.force.rename("spring_position"), SPHERE)
    with pytest.raises(ValueError, match="extra is not a variable of a surface or a cycle; drop"):
        cf.in_si_units(loop.assign(extra=loop.force), SPHERE)
    with pytest.raises(ValueError, match="the array lacks a name"):
        cf.in_si_units(loop.force.rename(None), SPHERE)


def test_plots_draw_on_given_axes_and_leave_nothing_behind(surface, loop, jumps):
    target_axes = axes_of_a_figure()
    assert cf.plot_loop(loop, target_axes) is target_axes
    branch = loop.direction.values == 1
    markers = next(line for line in target_axes.get_lines() if line.get_label() == "approach")
    np.testing.assert_array_equal(markers.get_ydata(), loop.mean_radius[branch])
    for drawn in (
        cf.plot_fronts(loop, surface, axes_of_a_figure()),
        cf.plot_surface(surface, axes_of_a_figure()),
        cf.plot_spectrum(surface, axes_of_a_figure()),
        cf.plot_instabilities(jumps, axes_of_a_figure()),
    ):
        assert drawn.get_xlabel()
        drawn.figure.canvas.draw()
    assert pyplot.get_fignums() == []


def test_what_is_in_si_units_is_drawn_in_them(surface, loop, jumps):
    surface_si, loop_si, jumps_si = (
        cf.in_si_units(item, SPHERE) for item in (surface, loop, jumps)
    )
    drawn = cf.plot_loop(loop_si, axes_of_a_figure())
    approach = next(line for line in drawn.get_lines() if line.get_label() == "approach")
    branch = loop_si.isel(step=loop_si.direction.values == 1)
    np.testing.assert_allclose(approach.get_xdata(), branch.force, rtol=1e-12)
    np.testing.assert_allclose(approach.get_ydata(), branch.mean_radius, rtol=1e-12)
    assert drawn.xaxis.get_major_formatter()(-2e-4) == "−200"
    assert drawn.yaxis.get_major_formatter()(50e-6) == "50"
    assert (drawn.get_xlabel(), drawn.get_ylabel()) == (
        "normal force (µN)",
        "mean contact radius (µm)",
    )
    image = cf.plot_surface(surface_si, axes_of_a_figure()).get_images()[0]
    np.testing.assert_allclose(image.get_array(), surface_si.values.T, rtol=1e-12)
    density = cf.plot_spectrum(surface_si, axes_of_a_figure()).get_lines()[0].get_data()
    reduced = cf.plot_spectrum(surface, axes_of_a_figure()).get_lines()[0].get_data()
    np.testing.assert_allclose(density[0], reduced[0] / SPHERE.lateral, rtol=1e-9)
    square = (SPHERE.lateral * SPHERE.vertical) ** 2
    np.testing.assert_allclose(density[1], reduced[1] * square, rtol=1e-9)
    for item in (surface, surface_si):
        fronts = cf.plot_fronts(loop_si, item, axes_of_a_figure()).get_lines()
        largest = float(loop_si.radius.max())
    assert np.max(np.hypot(*fronts[0].get_data())) <= largest * (1 + 1e-12)
    [patches] = cf.plot_instabilities(jumps_si, axes_of_a_figure()).collections
    assert patches.get_array().max() == pytest.approx(float(jumps_si.dissipated_energy.max()))


def test_the_patches_of_the_instabilities_have_the_area_of_the_sites_that_moved(jumps):
    [patches] = cf.plot_instabilities(jumps, axes_of_a_figure()).collections
    area = 0.0
    for path in patches.get_paths():
        x, y = path.vertices.T
        area += abs(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1])) / 2
    moved = np.abs(jumps.after - jumps.before) > jumps.attrs["travel"]
    swept = (jumps.before**2 - jumps.after**2) / 2 * 2 * np.pi / jumps.sizes["angle"]
    assert area == pytest.approx(float(swept.where(moved).sum()), rel=0.05)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda surface, loop, jumps: cf.plot_loop(loop.drop_vars("force")), "it lacks force"),
        (lambda surface, loop, jumps: cf.plot_fronts(loop.drop_vars("radius")), "fronts=True"),
        (lambda surface, loop, jumps: cf.plot_fronts(loop * np.nan), "radius .* not finite; drop"),
        (
            lambda surface, loop, jumps: cf.plot_loop((loop * np.nan).assign_attrs(loop.attrs)),
            "force of the loop lacks a finite value to plot",
        ),
        (lambda surface, loop, jumps: cf.plot_spectrum(0 * surface), "the surface is flat"),
        (
            lambda surface, loop, jumps: cf.plot_instabilities(jumps[{"instability": []}]),
            "lacks an instability",
        ),
        (
            lambda surface, loop, jumps: cf.plot_spectrum(
                (1 + surface).rename("work_of_adhesion").assign_attrs(units=ADHESION)
            ),
            "surface is work_of_adhesion; give heights",
        ),
    ],
)
def test_what_cannot_be_plotted_is_refused_and_leaves_no_figure(
    surface, loop, jumps, call, sentence
):
    with pytest.raises(ValueError, match=sentence):
        call(surface, loop, jumps)
    assert pyplot.get_fignums() == []
