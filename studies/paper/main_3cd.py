"""Main Fig. 3c, d: the smooth loop of a finely rough sphere, and its two fronts at b = 0."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.image import AxesImage
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from pydantic import Field

from crackfront.analysis.estimate import REACH, Estimate, with_error, with_interval
from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.law_spheres import sphere_factors
from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.record import Recorder
from crackfront.core.field.rays import front_adhesion
from crackfront.core.outcome import Direction
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.plots.fronts import RETRACTION, label_plane
from crackfront.plots.loop_figures import draw_loop
from crackfront.plots.parts import ADHESION_LABEL, field_colours
from crackfront.plots.style import BLACK, BLUE, PAGE, VERMILION, blank_figure, explain, house_style
from crackfront.simulate.numerical_errors import stated_error
from crackfront.simulate.simulation import simulation_adhesion, simulation_field
from crackfront.validation import Positive
from studies.paper.checks import Check, close_to
from studies.paper.drawing import name_panels
from studies.paper.figure import Figure, Integers, values_of
from studies.paper.rough import (
    ONE_DIGIT,
    RoughCycleParameters,
    expected_seconds,
    patch_of,
    recorded,
    rough_spectrum,
    whole_cycle,
)
from studies.progress import Progress

_STATE, _ANGLE, _FRONT, _X, _Y = "state", "angle", "front", "x", "y"
_BRANCH, _CLOSE_X, _CLOSE_Y = "branch", "close_x_point", "close_y_point"

FRONTS = ("approach", "retraction", "rigid circle")
"""Order of the fronts at b = 0."""

_N_ARC = 32
"""Arcs of a front whose means count as independent."""

_PATCH_POINTS = 600
"""Points along a side of the patch of the field."""

_CLOSE_POINTS = 240
"""Points along a side of the patch around one front."""


class PinnedLoopParameters(RoughCycleParameters):
    """What Fig. 3c and 3d show."""

    roll_off: Positive  # of the spectrum (reduced lateral length)
    hurst: Annotated[float, Field(gt=0, le=1)]
    patch_side: Positive  # of the part of the field that is shown (reduced lateral length)
    close_side: Positive  # and of the parts around a front, where its meandering is seen

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Shape of the spectrum."""
        return rough_spectrum(self.short_cutoff, self.roll_off, self.hurst)


@dataclass(frozen=True, slots=True)
class PinnedLoop:
    """States of the cycle, its fronts at b = 0 and the field around them."""

    status: str = variable("what ended the cycle", "1")
    short_cutoff: float = variable("shortest wavelength lambda_s", LATERAL)
    roll_off: float = variable("roll-off wavelength lambda_r", LATERAL)
    hurst: float = variable("Hurst exponent", "1")
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    direction: Integers = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", VERTICAL, _STATE)
    mean_radius: Array = variable("mean contact radius", LATERAL, _STATE)
    force: Array = variable("normal force", FORCE, _STATE)
    approach: float = variable("w_appr in the window", ADHESION)
    retraction: float = variable("w_retr in the window", ADHESION)
    approach_error: float = variable("standard error of w_appr", ADHESION)
    retraction_error: float = variable("standard error of w_retr", ADHESION)
    lowest_radius: float = variable("smallest mean radius of the window", LATERAL)
    highest_radius: float = variable("largest mean radius of the window", LATERAL)
    angle: Array = variable("angle of a site", "rad", _ANGLE)
    front: Array = variable(f"at b = 0: {', '.join(FRONTS)}", LATERAL, _FRONT, _ANGLE)
    front_adhesion: Array = variable("w_loc under the fronts", ADHESION, _FRONT, _ANGLE)
    front_release: Array = variable("G_JKR at the fronts", ADHESION, _FRONT, _ANGLE)
    x: Array = variable("abscissa of the patch, along the first ray", LATERAL, _X)
    y: Array = variable("ordinate of the patch", LATERAL, _Y)
    patch: NDArray[np.float32] = variable("local work of adhesion", ADHESION, _X, _Y)
    close_x: Array = variable("abscissa around a front", LATERAL, _BRANCH, _CLOSE_X)
    close_y: Array = variable("ordinate around the fronts", LATERAL, _CLOSE_Y)
    close_patch: NDArray[np.float32] = variable(
        "local work of adhesion around a front", ADHESION, _BRANCH, _CLOSE_X, _CLOSE_Y
    )


def pinned_loop(parameters: PinnedLoopParameters, progress: Progress) -> PinnedLoop:
    """One full cycle of a finely rough sphere, with both fronts at b = 0."""
    simulation = parameters.simulation()
    adhesion = simulation_adhesion(simulation)
    progress(f"surface: e_el {adhesion.e_el:.4f}, w_rms {adhesion.w_rms:.4f} w_int")
    field = simulation_field(simulation, adhesion)
    fronts: list[Array] = []

    def observe(recorder: Recorder) -> None:
        if recorder.states[-1].penetration == 0:
            fronts.append(recorder.front)
            progress(f"{FRONTS[len(fronts) - 1]}: mean radius {fronts[-1].mean():.4f} at b = 0")

    record = recorded(simulation, field, parameters.schedule.loads(), Recorder(observers=[observe]))
    if len(fronts) < 2:
        raise ValueError(f"the cycle ended before its two fronts at b = 0: {record.status.value}")
    correlation_length = simulation.spectrum.correlation_length
    steady = steady_adhesion(record, correlation_length)
    if steady.sentence:
        raise ValueError(steady.sentence)
    numerical = stated_error(simulation, steady, correlation_length)
    circle = jkr.equilibrium_radius(0.0, 1 - adhesion.e_el)
    front = np.stack([*fronts, np.full(fronts[0].size, circle)])
    across = (np.arange(_PATCH_POINTS) / (_PATCH_POINTS - 1) - 0.5) * parameters.patch_side
    x = across + np.mean([front[0, 0], front[1, 0]])
    close = (np.arange(_CLOSE_POINTS) / (_CLOSE_POINTS - 1) - 0.5) * parameters.close_side
    close_x = close + front[:2, :1]
    return PinnedLoop(
        status=record.status.value,
        **values_of(parameters, "short_cutoff", "roll_off", "hurst"),
        elastic_energy=adhesion.e_el,
        **values_of(record.states, "direction", "penetration", "mean_radius", "force"),
        approach=steady.w_appr,
        retraction=steady.w_retr,
        approach_error=math.hypot(steady.w_appr_error, numerical[0]),
        retraction_error=math.hypot(steady.w_retr_error, numerical[1]),
        **values_of(steady, "lowest_radius", "highest_radius"),
        angle=2 * np.pi * np.arange(front.shape[1]) / front.shape[1],
        front=front,
        front_adhesion=np.stack([front_adhesion(line, field) for line in front]) / WORK_OF_ADHESION,
        front_release=jkr.apparent_work_of_adhesion(front, 0.0),
        x=x,
        y=across,
        patch=patch_of(field, x, across),
        close_x=close_x,
        close_y=close,
        close_patch=np.stack([patch_of(field, along, close) for along in close_x]),
    )


def pinned_loop_checks(loop: PinnedLoop) -> tuple[Check, ...]:
    """The works of adhesion of the paper's k = 3, and what the fronts sample."""
    return (*_loop_checks(loop), *_front_checks(loop))


def _loop_checks(loop: PinnedLoop) -> tuple[Check, ...]:
    """Works of adhesion of both branches (main Fig. 3c)."""
    energy = loop.elastic_energy
    spectrum = SelfAffineSpectrum(loop.short_cutoff, loop.roll_off, loop.hurst)
    radius = (loop.lowest_radius + loop.highest_radius) / 2
    law = sphere_factors("roughness", spectrum, energy, radius)
    error = math.hypot(loop.approach_error, loop.retraction_error)
    factor = (loop.retraction - loop.approach) / (2 * energy)
    remark = (
        f"k of this loop is {with_error(factor, error / (2 * energy))}, by the law at its size "
        f"{with_interval(law.both)}; tolerance: what one digit of k leaves, {ONE_DIGIT:g} e_el, "
        f"with {energy:.4f} w_int on the tile"
    )

    def branch_check(
        name: str, sign: Direction, work: float, work_error: float, by_law: Estimate[float]
    ) -> Check:
        law_error = math.hypot(by_law.standard_error * energy, work_error)
        return close_to(
            name,
            work,
            1 - energy + sign * PAPER_FACTOR * energy,
            ONE_DIGIT * energy,
            units=ADHESION,
            remark=remark,
            law=(1 - energy + sign * by_law.value * energy, REACH * law_error),
        )

    return (
        whole_cycle(loop.status),
        branch_check(
            "w_appr = w_int - e_el - 3 e_el (main text)",
            -1,
            loop.approach,
            loop.approach_error,
            law.approach.factor,
        ),
        branch_check(
            "w_retr = w_int - e_el + 3 e_el (main text)",
            1,
            loop.retraction,
            loop.retraction_error,
            law.retraction.factor,
        ),
        close_to(
            "the branches lie symmetrically about w_int - e_el",
            (loop.approach + loop.retraction) / 2,
            1 - energy,
            3 * error / 2,
            units=ADHESION,
            remark="tolerance: three standard errors, of the states and of the numerics",
        ),
    )


def _front_checks(loop: PinnedLoop) -> tuple[Check, ...]:
    """What the fronts at b = 0 sample of the field (main Fig. 3d)."""
    balance = np.mean(loop.front * (loop.front_adhesion - loop.front_release), axis=1)
    imbalance = np.max(np.abs(balance[:2] / np.mean(loop.front[:2], axis=1)))
    relations: tuple[Relation, ...] = ("below", "above", "at")
    fronts = zip(FRONTS, relations, loop.front_adhesion, strict=True)
    return (
        *(_sample_check(1 - loop.elastic_energy, *front) for front in fronts),
        close_to(
            "means of a w_loc and of a G are equal on both fronts: the line's elasticity cancels",
            float(imbalance),
            0.0,
            1e-3,
            units=ADHESION,
            remark="tolerance: the largest force that the numerics may leave",
        ),
    )


Relation = Literal["below", "above", "at"]
"""How the mean over a front compares with the mean of the field."""


def _sample_check(mean: float, name: str, relation: Relation, sampled: Array) -> Check:
    """Whether a front samples works of adhesion below, above or at the mean of the field."""
    arcs = [arc.mean() for arc in np.array_split(sampled, _N_ARC)]
    reach = float(3 * np.std(arcs, ddof=1) / math.sqrt(_N_ARC))
    sampled_mean = float(sampled.mean())
    if relation == "below":
        expected, passed = f"below {mean - reach:.4f}", sampled_mean < mean - reach
    elif relation == "above":
        expected, passed = f"above {mean + reach:.4f}", sampled_mean > mean + reach
    else:
        expected, passed = with_error(mean, reach), abs(sampled_mean - mean) <= reach
    return Check(
        f"w_loc under the front at b = 0, {name}: {relation} the mean of the field",
        f"{expected} {ADHESION}",
        f"{sampled_mean:.4f} {ADHESION}",
        passed,
        f"the mean is {mean:.4f}; three standard errors, from the means of {_N_ARC} arcs",
    )


def pinned_loop_figure(loop: PinnedLoop) -> Drawing:
    """The loop, the fronts of both branches at b = 0, and both fronts from close by."""
    with house_style():
        figure = blank_figure(PAGE, 0.52 * PAGE)
        panels = figure.subplot_mosaic(
            [["c", "d", "approach"], ["c", "d", "retraction"]], width_ratios=(1.2, 1.1, 0.6)
        )
        works, window = (loop.approach, loop.retraction), (loop.lowest_radius, loop.highest_radius)
        draw_loop(panels["c"], loop, works, window, elastic_energy=loop.elastic_energy)
        panels["c"].get_legend().remove()  # type: ignore[union-attr]
        _draw_fronts(panels["d"], loop)
        handles, labels = panels["c"].get_legend_handles_labels()
        # The fronts of the branches have the colours of c.
        circle = panels["d"].get_legend_handles_labels()[0][-1]
        entries = [*handles, circle], [*labels, f"{FRONTS[-1]} (d)"]
        figure.legend(*entries, loc="outside upper center", ncols=4)
        for branch, name in enumerate(FRONTS[:2]):
            image = _draw_close(panels[name], loop, branch)
            _outline(panels["d"], loop, branch)
        bar = figure.colorbar(image, ax=[panels[name] for name in FRONTS[:2]], extend="both")
        bar.set_label(rf"local {ADHESION_LABEL}")
        name_panels((panels["c"], panels["d"]), "cd")
        explain(
            figure,
            "arrows: the direction of motion; d: the fronts at $b=0$; right: the squares of d, "
            f"{loop.close_y[-1] - loop.close_y[0]:.2g} wide; in approach the front rests at places "
            "of low adhesion (white), in retraction at places of high adhesion",
        )
        return figure


_STYLES = ((BLUE, "-"), (VERMILION, RETRACTION), (BLACK, (0, (4, 2))))
"""Colours and line styles of the fronts."""


def _draw_fronts(axes: Axes, loop: PinnedLoop) -> None:
    """The part of the fronts that crosses the patch of the field."""
    _draw_field(axes, loop, loop.x, loop.y, loop.patch)
    for front in range(len(FRONTS)):
        _draw_front(axes, loop, front, loop.y[-1])
    label_plane(axes)


def _draw_close(axes: Axes, loop: PinnedLoop, branch: int) -> AxesImage:
    """Field and front of a branch from close by."""
    x = loop.close_x[branch]
    image = _draw_field(axes, loop, x, loop.close_y, loop.close_patch[branch])
    _draw_front(axes, loop, branch, loop.close_y[-1])
    axes.set(xticks=[], yticks=[], title=FRONTS[branch])
    return image


def _outline(axes: Axes, loop: PinnedLoop, branch: int) -> None:
    """Square around the part of a front that is also shown from close by."""
    x, y = loop.close_x[branch], loop.close_y
    square = Rectangle(
        (x[0], y[0]), x[-1] - x[0], y[-1] - y[0], fill=False, color=BLACK, linewidth=0.8, zorder=4
    )
    axes.add_patch(square)


def _draw_field(
    axes: Axes, loop: PinnedLoop, x: Array, y: Array, patch: NDArray[np.float32]
) -> AxesImage:
    """A patch of the field, with the greys of all patches."""
    mean, reach = 1 - loop.elastic_energy, 4 * np.sqrt(loop.elastic_energy)
    extent = (x[0], x[-1], y[0], y[-1])
    image = axes.imshow(
        patch.T,
        origin="lower",
        extent=extent,
        cmap=field_colours(),
        vmin=mean - reach,
        vmax=mean + reach,
        interpolation="antialiased",
    )
    axes.set(xlim=extent[:2], ylim=extent[2:])
    return image


def _draw_front(axes: Axes, loop: PinnedLoop, front: int, reach: float) -> None:
    """A front about the first ray, as far as ordinates of a reach need."""
    # From -pi to pi, so that the part about the first ray is one line.
    half = loop.angle.size // 2
    angle = np.roll(np.where(loop.angle < np.pi, loop.angle, loop.angle - 2 * np.pi), half)
    radius, (colour, style) = np.roll(loop.front[front], half), _STYLES[front]
    near = np.abs(angle) < 2 * reach / loop.x[0]
    x, y = (radius * np.cos(angle))[near], (radius * np.sin(angle))[near]
    axes.plot(x, y, color=colour, linestyle=style, linewidth=1.2, label=FRONTS[front])
    # A white rim, as fronts and field are of similar greys in print.
    axes.plot(x, y, color="white", linewidth=3.0, zorder=1.5)


FIGURE = Figure(
    title="Main Fig. 3c, d: the smooth loop of a finely rough sphere, and its fronts at b = 0",
    compute=pinned_loop,
    checks=pinned_loop_checks,
    draw=pinned_loop_figure,
    seconds=expected_seconds,
)
