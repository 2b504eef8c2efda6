"""The study of numerical errors: orders of convergence, laws, coverage, averages, report."""

import math
import re
from dataclasses import asdict, fields, replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import stats

from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.data.files import write_dataset
from crackfront.data.provenance import provenance
from crackfront.simulate.contact import simulation_field
from crackfront.simulate.laws import LAW_SIZE, chosen_knobs, read_laws
from studies.__main__ import main
from studies.accuracy.averages import (
    Coverage,
    Sample,
    held_out_coverage,
    sampling_errors,
)
from studies.accuracy.files import (
    SECONDS,
    STUDIES,
    errors_dataset,
    read_errors,
    read_study,
    records_dataset,
)
from studies.accuracy.fitting import fit_laws, laws_text
from studies.accuracy.scenes import HELD_OUT, SCENES, with_knob
from studies.accuracy.study import (
    Errors,
    SceneErrors,
    front_difference,
    measured_branches,
    pareto_front,
    scene_errors,
)

MODERATE, SMALL = SCENES["chemical-0.04"], SCENES["small-0.04"]

UNSEEN = re.compile("c015|f013|band|h02|h05|h09")

# So weak that no front is pinned: errors are smooth, and their orders those of the theory.
FINEST = replace(
    MODERATE.reference,
    angles_per_cutoff=4,
    samples_per_cutoff=48,
    pixels_per_cutoff=24,
    tolerance=1e-10,
)
WEAK = replace(
    MODERATE,
    spectrum=SelfAffineSpectrum(0.08, 0.08, 1.0),
    elastic_energy=4e-4,
    tile_cutoffs=32,
    reference=FINEST,
)


@pytest.fixture(scope="module")
def converged():
    return [measured_branches(WEAK, FINEST, number) for number in range(3)]


def error_of_the_front(numerics, converged):
    """Rms error of the radius on the surfaces of the weak scene."""
    found = [measured_branches(WEAK, numerics, number) for number in range(3)]
    pairs = zip(found, converged, strict=True)
    return math.sqrt(
        np.mean([np.mean(front_difference(a.radius, b.radius) ** 2) for a, b in pairs])
    )


@pytest.mark.parametrize(
    ("knob", "coarse", "fine", "order"),
    [
        ("cubic", 6, 16, 4),
        ("linear", 16, 64, 2),
        ("pixels", 4, 12, 4),
        ("tolerance", 1e-2, 1e-6, -1),
    ],
)
def test_the_front_converges_with_the_order_of_the_knob(converged, knob, coarse, fine, order):
    errors = [
        error_of_the_front(with_knob(FINEST, knob, value), converged) for value in (coarse, fine)
    ]
    observed = -math.log(errors[1] / errors[0]) / math.log(fine / coarse)
    assert abs(observed - order) < 0.3


def test_more_sites_converge_faster_than_any_power(converged):
    errors = [
        error_of_the_front(with_knob(FINEST, "sites", value), converged) for value in (1.4, 2, 2.8)
    ]
    orders = np.diff(np.log(errors)) / np.log(np.sqrt(2))
    assert np.all(orders < -5)


def test_the_mean_over_realisations_converges_with_the_root_of_their_number():
    schedule = LoadSchedule(1.0, 0.2)
    numerics = chosen_knobs(0.1, "roughness", SMALL.spectrum, 0.04)
    values = []
    for number in range(64):
        field = simulation_field(replace(SMALL.simulation(numerics, number), schedule=schedule))
        record = run_cycle(field, schedule, Newton(numerics.tolerance))
        values.append(
            record.states.apparent_work_of_adhesion[record.states.direction < 0][:4].mean()
        )
    single = np.std(values, ddof=1)
    of_four = np.std(np.mean(np.reshape(values, (16, 4)), axis=1), ddof=1)
    assert abs(math.log(of_four / single) / math.log(4) + 0.5) < 0.3


def test_a_branch_has_the_states_of_a_full_cycle_at_the_same_loads():
    numerics = chosen_knobs(0.03, "roughness", SMALL.spectrum, 0.04)
    numerics = replace(numerics, tolerance=1e-9)
    branches = measured_branches(SMALL, numerics, 1)
    simulation = SMALL.simulation(numerics, 1)
    field = simulation_field(simulation)
    cycle = run_cycle(field, LoadSchedule(1.0, 0.1), Newton(1e-9), Recorder(fronts=True))
    approach = cycle.states.direction > 0
    assert np.allclose(SMALL.penetrations, cycle.states.penetration[approach][-8:])
    assert np.allclose(branches.radius[0], cycle.fronts[approach][-8:], rtol=0, atol=1e-7)
    # The branch begins outside the turn of the cycle, which has left the turn behind at 0.4.
    assert np.allclose(cycle.states.penetration[~approach][5:7], SMALL.penetrations[1::-1])
    retraction = cycle.fronts[~approach][5:7]
    assert np.allclose(branches.radius[1, 1::-1], retraction, rtol=0, atol=1e-7)


def test_fronts_are_compared_as_trigonometric_ones():
    angle = [2 * np.pi * np.arange(n) / n for n in (16, 40)]
    coarse, fine = (2 + 0.1 * np.cos(3 * t) + 0.05 * np.sin(5 * t) for t in angle)
    assert np.max(np.abs(front_difference(coarse, fine))) < 1e-14
    assert front_difference(coarse + 0.25, fine) == pytest.approx(0.25)


def test_a_setting_of_one_knob_leaves_the_others_as_in_the_reference_but_for_few_sites():
    names = {
        "sites": {"angles_per_cutoff"},
        "cubic": {"samples_per_cutoff"},
        "linear": {"samples_per_cutoff", "interpolation"},
        "pixels": {"pixels_per_cutoff"},
        "tolerance": {"tolerance"},
    }
    for knob, value, numerics in MODERATE.single_settings:
        if knob in names:
            changed = {
                name
                for name in MODERATE.reference.__dataclass_fields__
                if getattr(numerics, name) != getattr(MODERATE.reference, name)
            }
            assert changed - {"angles_per_cutoff"} <= names[knob]
            assert numerics.angles_per_cutoff == (value if knob == "sites" else 2.2)
            assert value in {getattr(numerics, name) for name in names[knob]}


@pytest.fixture(scope="module")
def small_study():
    finer = [setting for setting in SMALL.single_settings if setting[0] == "finer"]
    return scene_errors(SMALL, finer + SMALL.asked_settings(), range(3))


def test_errors_fall_with_the_error_that_is_asked_for_and_time_grows(small_study):
    assert SMALL.elastic_energy == 0.04
    asked = [errors for errors in small_study.errors if errors.knob == "asked"]
    rms = {errors.value: np.sqrt(np.mean(errors.state**2)) for errors in asked}
    seconds = [errors.seconds.mean() for errors in asked]
    assert rms[0.1] > 3 * rms[0.003]
    assert seconds[0] < seconds[-1]
    for errors in asked:
        assert np.all(np.abs(errors.adhesion) <= errors.state * (1 + 1e-12))
        assert np.all(errors.front_rms <= errors.front_max)
    finer = small_study.errors[0]
    assert finer.knob == "finer"
    # One surface may have an avalanche that the reference just misses.
    assert np.median(np.abs(finer.adhesion)) < 0.01 * np.max(np.abs(asked[0].adhesion))


def test_errors_are_relative_to_the_mean_hysteresis(small_study):
    errors = replace(small_study.errors[0], adhesion=np.array([[0.0, 0.01]] * 3))
    mean = np.mean(small_study.reference_adhesion[:, 1] - small_study.reference_adhesion[:, 0])
    assert small_study.hysteresis_errors(errors) == pytest.approx(0.01 / mean)


def test_a_study_is_read_as_it_was_written(small_study, tmp_path):
    path = tmp_path / "numerics.nc"
    write_dataset(path, errors_dataset(small_study), provenance())
    again = read_errors(path)
    assert again.scene == SMALL
    assert np.array_equal(again.reference_adhesion, small_study.reference_adhesion)
    assert np.array_equal(again.reference_seconds, small_study.reference_seconds)
    for one, other in zip(again.errors, small_study.errors, strict=True):
        for item in fields(Errors):
            assert np.array_equal(getattr(one, item.name), getattr(other, item.name)), item.name
    with pytest.raises(ValueError, match="does not exist; check the name"):
        read_errors(tmp_path / "none.nc")
    with pytest.raises(ValueError, match="is no file; check the name"):
        read_errors(tmp_path)


def test_no_setting_of_the_pareto_front_is_beaten():
    rng = np.random.default_rng(3)
    seconds, error = rng.uniform(size=(2, 40))
    best = pareto_front(seconds, error)
    for index in range(40):
        beaten = np.any((seconds < seconds[index]) & (error < error[index]))
        assert (index in best) == (not beaten)
    assert np.all(np.diff(seconds[best]) > 0)
    assert list(pareto_front(np.array([1.0, 1.0, 2.0]), np.array([2.0, 1.0, 1.0]))) == [1]


def gaussian(rng, shape):
    """Scatter of unit variance."""
    return rng.standard_normal(shape)


def rare(rng, shape):
    """Scatter of unit variance, of one value in ten."""
    return math.sqrt(10) * (rng.uniform(size=shape) < 0.1) * rng.choice([-1, 1], size=shape)


def synthetic_study(bias, scatter, noise=gaussian, n_realisation=400, seed=5):
    """A study whose errors of k have a given bias and scatter, by knob and value."""
    rng = np.random.default_rng(seed)
    one, signs = np.ones(n_realisation), np.array([-1, 1])
    errors, of_few_sites = [], 0.0
    for knob, value, numerics in MODERATE.single_settings:
        if knob == "finer":
            continue
        of_k = scatter(knob, value) * noise(rng, (n_realisation, 2)) + signs * bias(knob, value)
        if knob != "sites":
            of_k += of_few_sites
        elif value == 2.2:
            of_few_sites = of_k
        adhesion = MODERATE.elastic_energy * of_k
        knobs = {name: of for name, of in asdict(numerics).items() if name != "angles"}
        errors.append(Errors(knob, value, one, adhesion, adhesion**2, one, one, one, **knobs))
    reference = np.tile([0.9, 1.0], (n_realisation, 1))
    return SceneErrors(MODERATE, tuple(errors), reference, one)


def test_rare_avalanches_count_with_their_mean_square():
    def law(seed):
        study = synthetic_study(
            lambda *_: 0.0, lambda knob, value: value**-3.0, rare, n_realisation=8, seed=seed
        )
        return next(law for law in fit_laws([study]) if law.knob == "cubic")

    squares = [(law(seed).error(3, LAW_SIZE) * 3**3) ** 2 for seed in range(60)]
    assert 0.8 < np.mean(squares) < 1.25


def test_the_fit_finds_the_law_behind_the_errors():
    def bias(knob, value):
        return math.exp(1 - 2 * value) if knob == "sites" else 0.0

    def scatter(knob, value):
        return 0.3 * value**-3 if knob == "cubic" else 1e-3

    laws = {(law.knob, law.direction): law for law in fit_laws([synthetic_study(bias, scatter)])}
    assert laws["sites", -1].bias == pytest.approx((1, -2), abs=0.1)
    assert laws["cubic", 1].scatter == pytest.approx((math.log(0.3), -3), abs=0.2)
    assert laws["cubic", 1].error(4, LAW_SIZE) == pytest.approx(0.3 / 64, rel=0.1)
    assert laws["cubic", 1].error(4, 4 * LAW_SIZE) == pytest.approx(0.15 / 64, rel=0.1)


def test_laws_are_written_in_full(tmp_path):
    laws = list(fit_laws([synthetic_study(lambda *_: 0.01, lambda *_: 0.01)]))
    lines = laws_text(laws).splitlines()
    assert len(lines) == 1 + len(laws) == 11
    assert lines[0].startswith("shape,elastic_energy,knob,direction,bias_0")
    assert lines[1].startswith("chemical,0.04,sites,1,")


def largest_error(name, n_realisation, asked=0.03):
    """The larger rms error of k of both branches of held-out surfaces, relative to that asked."""
    scene = SCENES[name]
    numbers = range(HELD_OUT, HELD_OUT + n_realisation)
    (found,) = scene_errors(scene, scene.asked_settings([asked]), numbers).errors
    return np.max(np.sqrt(np.mean(found.adhesion**2, axis=0))) / scene.elastic_energy / asked


def test_laws_hold_for_a_band_between_the_shapes_that_they_know():
    assert largest_error("band-0.1", 2) < 1.5


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("name", [name for name in SCENES if UNSEEN.match(name)])
def test_laws_hold_within_half_for_spectra_and_surfaces_they_never_saw(name):
    assert largest_error(name, 8) < 1.5


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_the_laws_of_the_package_are_those_that_the_study_gives():
    stored = {
        (law.knob, law.direction): law
        for law in read_laws()
        if (law.shape, law.elastic_energy) == ("h08", 0.0025)
    }
    scene = SCENES["h08-0.0025"]
    study = scene_errors(scene, scene.single_settings, range(24))
    for law in fit_laws([study]):
        before = stored[law.knob, law.direction]
        assert law.bias == pytest.approx(before.bias, abs=0.02)
        assert law.scatter == pytest.approx(before.scatter, abs=0.02)
        assert law.avalanche == pytest.approx(before.avalanche, abs=0.001)


@pytest.fixture(scope="module")
def coverage():
    return held_out_coverage(SCENES["flat-0.04"], (0.1, 0.03), 5)


def check_stated_errors(items):
    """Intervals cover nine errors in ten; standard errors are not three times the median error."""
    for name, standard_error_of in (
        ("total", lambda item: np.hypot(item.run_numerical, item.run_statistical)),
        ("numerical", lambda item: item.numerical_stated + 0 * item.numerical),
    ):
        error, interval, stated = (
            np.concatenate([np.ravel(part(item)) for item in items])
            for part in (
                lambda item, name=name: abs(getattr(item, name)),
                lambda item, name=name: getattr(item, f"{name}_interval"),
                standard_error_of,
            )
        )
        known = np.isfinite(error) & np.isfinite(interval)
        assert np.mean(error[known] <= interval[known]) >= 0.9, name
        assert np.median(stated[known] / error[known]) <= 3, name


def test_the_stated_errors_cover_nine_in_ten_and_are_not_three_times_too_large(coverage):
    check_stated_errors(coverage)


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_the_stated_errors_cover_nine_in_ten_over_shapes_and_amplitudes():
    names = [
        f"{shape}-{energy}"
        for shape in ("chemical", "flat", "h08", "h03")
        for energy in (0.01, 0.16)
    ]
    check_stated_errors(
        [item for name in names for item in held_out_coverage(SCENES[name], (0.1, 0.03), 8)]
    )


def test_coverage_is_read_as_it_was_written(coverage, tmp_path):
    path = tmp_path / "coverage.nc"
    dataset = records_dataset("true and stated errors", SCENES["flat-0.04"], coverage)
    write_dataset(path, dataset, provenance())
    scene, again = read_study(path, Coverage)
    assert scene == SCENES["flat-0.04"]
    assert np.array_equal(again[0].total, coverage[0].total)
    assert again[0].asked == 0.1


def test_student_intervals_are_wider_than_normal_ones_where_states_are_few(coverage):
    item = coverage[0]
    none = np.zeros_like(item.total)
    exact = replace(item, run_numerical=none, truth_error=none)
    few, many = (
        replace(exact, n_state=np.full(item.total.shape, count)).total_interval
        for count in (3.0, 1e9)
    )
    assert few / many == pytest.approx(stats.t.ppf(0.96, 2) / stats.norm.ppf(0.96))
    assert np.all(item.total_interval > item.run_numerical)


@pytest.mark.slow
def test_schedules_change_the_mean_within_its_error(tmp_path):
    samples = sampling_errors(SCENES["flat-0.04"], range(3))
    path = tmp_path / "averages.nc"
    dataset = records_dataset("errors of averaging", SCENES["flat-0.04"], samples)
    write_dataset(path, dataset, provenance())
    scene, again = read_study(path, Sample)
    assert scene == SCENES["flat-0.04"]
    assert [item.knob for item in again] == [item.knob for item in samples]
    schedules = [item for item in again if item.knob != "tile"]
    known = [item for item in schedules if np.all(np.isfinite(item.hysteresis))]
    assert len(known) >= len(schedules) - 1
    for item in known:
        difference = np.mean(item.hysteresis - again[0].hysteresis)
        assert abs(difference) < 2 * np.mean(item.standard_error)
    seconds = [item.seconds.mean() for item in known if item.knob == "step"]
    assert seconds[0] > 2 * seconds[-1]


def test_the_commands_measure_a_scene_and_report_it(tmp_path):
    run = CliRunner().invoke
    output = ["--output", str(tmp_path)]
    empty = run(main, ["accuracy", "report", *output])
    assert empty.exit_code == 2
    assert "holds no errors; run python -m studies accuracy scene" in empty.output
    measured = run(
        main,
        ["accuracy", "scene", "small-0.04", "--study", "asked", "--realisations", "2", *output],
    )
    assert measured.exit_code == 0, measured.output
    assert "asked 0.03: rms error of k" in measured.output
    reported = run(main, ["accuracy", "report", *output])
    assert reported.exit_code == 0, reported.output
    text = (tmp_path / "accuracy.md").read_text()
    assert "## Time to an error of the hysteresis" in text
    assert "| small-0.04 | 0.01 |" in text
    assert "±" in text


def test_a_page_gets_the_measured_tables_and_keeps_its_words(tmp_path):
    run = CliRunner().invoke
    output = ["--output", str(tmp_path)]
    arguments = ["small-0.04", "--study", "asked", "--realisations", "2"]
    assert run(main, ["accuracy", "scene", *arguments, *output]).exit_code == 0
    page = tmp_path / "page.md"
    page.write_text("Before\n<!-- accuracy: Settings, small-0.04 -->\nold\n<!-- end -->\nAfter\n")
    reported = run(main, ["accuracy", "report", *output, "--page", str(page)])
    assert reported.exit_code == 0, reported.output
    text = page.read_text()
    assert text.startswith("Before\n")
    assert text.endswith("<!-- end -->\nAfter\n")
    assert "old" not in text
    assert "asked 0.03" in text
    page.write_text("<!-- accuracy: Settings, flat-0.04 --><!-- end -->")
    refused = run(main, ["accuracy", "report", *output, "--page", str(page)])
    assert refused.exit_code == 2
    assert "'Settings, flat-0.04', which the study accuracy has not measured" in refused.output


@pytest.mark.parametrize("study", STUDIES)
def test_the_cost_of_a_study_is_told_before_it_is_measured(study, tmp_path, monkeypatch):
    def measured(*_):
        raise ValueError("measured")

    monkeypatch.setitem(STUDIES, study, measured)
    arguments = ["accuracy", "scene", "large-0.04", "--study", study, "--realisations", "16"]
    stopped = CliRunner().invoke(main, [*arguments, "--output", str(tmp_path)])
    told, _ = stopped.stderr.split("Error: measured")
    assert re.fullmatch(r"about [\d.]+ (s|min|hours) of processor time\n", told)


def test_the_cost_of_a_study_is_that_of_its_runs():
    scene = SCENES["small-0.04"]
    found = scene_errors(scene, scene.asked_settings(), range(2))
    seconds = np.sum(found.reference_seconds) + sum(np.sum(one.seconds) for one in found.errors)
    assert seconds / 4 < 2 * SECONDS["asked"](scene) < 4 * seconds


def test_an_unknown_scene_is_refused_with_the_nearest_one():
    refused = CliRunner().invoke(main, ["accuracy", "scene", "flat-0.4"])
    assert refused.exit_code == 2
    assert "there is no scene 'flat-0.4'; did you mean flat-0.04?" in refused.output
