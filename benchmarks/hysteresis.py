"""Time against numerical error of the hysteresis, what a user waits for.

python -m benchmarks.hysteresis --case flat-0.4 --output results/benchmark

Every setting of the numerics runs the same realisations at the same penetrations, each branch from
the circle of :func:`crackfront.steady.forward_circle`; its error is the difference of
w_retr - w_appr from that of the finest setting, on the same surface.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from benchmarks.machine import described_machine
from crackfront import jkr
from crackfront.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.cycle import CycleRecord, FrontHistory, LoadSchedule, run_cycle
from crackfront.dataset.files import write_dataset
from crackfront.fits import steady_adhesion
from crackfront.pinning import Interpolation, TileField, first_radius, n_angle
from crackfront.plots import save_figure
from crackfront.plots.style import COLOURS, COLUMN, MARKERS, blank_figure, house_style
from crackfront.provenance import provenance
from crackfront.relax import Direction
from crackfront.scene import contact_field, correlation_length
from crackfront.spectrum import SelfAffineSpectrum
from crackfront.steady import SteadySchedule, forward_circle, run_steady
from crackfront.synthesis import gaussian_field

Array = NDArray[np.float64]

N_REALISATION = 8
TARGET = 0.01
"""Error of the hysteresis that the settings are judged by."""


@dataclass(frozen=True, slots=True)
class Setting:
    """Numerics; lengths relative to the short cutoff.

    Attributes
    ----------
    angles : float
        Sites per cutoff on the smooth contact's circle at penetration 1.
    samples : float
        Samples per cutoff along a ray.
    interpolation : {"cubic", "linear"}
        Pieces between them.
    pixels : int
        Points of the tile per cutoff.
    tolerance : float
        Force that may be left, relative to w_int per front length.
    """

    angles: float
    samples: float
    interpolation: Interpolation
    pixels: int
    tolerance: float

    @property
    def label(self) -> str:
        """A row's name."""
        return (
            f"{self.angles:g} sites, {self.samples:g} {self.interpolation}, {self.pixels} pixels, "
            f"{self.tolerance:g}"
        )


FINEST = Setting(8, 12, "cubic", 8, 1e-8)
BASE = Setting(5, 8, "cubic", 6, 1e-7)
FINE = Setting(3.6, 6, "cubic", 4, 1e-6)
CHOSEN = Setting(2.2, 5, "cubic", 4, 1e-5)


@dataclass(frozen=True, slots=True)
class Case:
    """Surfaces, and the penetrations at which both branches are measured.

    Attributes
    ----------
    name : str
        What the tables call it.
    rms : float
        w_rms / w_int.
    spectrum : SelfAffineSpectrum
        A flat one is that of the work of adhesion, another that of the heights.
    cutoffs : int
        Side of the tile in short cutoffs.
    step : float
        Difference of the eight penetrations, the largest of which is 1.
    authors_seconds : float or None
        CPU time of the authors' code for its full cycle, where it is known. (Units: s)
    finest : Setting
        What errors are measured against.
    """

    name: str
    rms: float
    spectrum: SelfAffineSpectrum
    cutoffs: int
    step: float
    authors_seconds: float | None = None
    finest: Setting = FINEST

    @property
    def title(self) -> str:
        """What a figure calls it."""
        spectrum = self.spectrum
        shape = f"flat, {spectrum.short_cutoff:g}"
        if spectrum.roll_off > spectrum.short_cutoff:
            shape = f"self-affine, ({spectrum.short_cutoff:g}, {spectrum.roll_off:g}, "
            shape += f"{spectrum.hurst:g})"
        return rf"{shape}, $w_\mathrm{{rms}} = {self.rms:.2g}\,w_\mathrm{{int}}$"

    @property
    def penetrations(self) -> Array:
        """Loads of the approach; the retraction has them in reverse."""
        return 1.0 - self.step * np.arange(7, -1, -1.0)


def _flat(cutoff: float) -> SelfAffineSpectrum:
    """Flat spectrum."""
    return SelfAffineSpectrum(cutoff, cutoff, 1.0)


CASES = (
    Case("flat-0.4", 0.4, _flat(0.02), 64, 0.1, authors_seconds=100.0),
    Case("flat-0.1", 0.1, _flat(0.02), 64, 0.1, authors_seconds=160.0),
    Case("h03", 2 * math.sqrt(0.05), SelfAffineSpectrum(0.005, 0.1, 0.3), 200, 0.03),
    Case(
        "h08", 2 * math.sqrt(0.05), SelfAffineSpectrum(0.000625, 0.01, 0.8), 256, 0.004, finest=FINE
    ),
)

FAMILIES = {
    "nothing": [BASE],
    "sites of the front": [replace(BASE, angles=n) for n in (1.4, 1.8, 2.2, 2.7, 3.6)],
    "cubic pieces": [replace(BASE, samples=n) for n in (2, 3, 4, 5, 6)],
    "linear pieces": [replace(BASE, samples=n, interpolation="linear") for n in (4, 8, 16, 32, 64)],
    "pixels of the tile": [replace(BASE, pixels=n) for n in (3, 4)],
    "tolerance": [replace(BASE, tolerance=t) for t in (1e-3, 1e-4, 1e-5, 1e-6)],
    "together": [
        replace(CHOSEN, angles=2.7),
        CHOSEN,
        Setting(2.2, 4, "cubic", 4, 1e-4),
        Setting(1.8, 4, "cubic", 4, 1e-4),
    ],
}
"""Settings by the knob that they vary; all are compared with the finest."""


@dataclass(frozen=True, slots=True)
class Row:
    """What one setting gave over the realisations; errors relative to the mean hysteresis."""

    family: str
    setting: Setting
    seconds: float
    bias: float
    bias_error: float
    rms: float


def surface(case: Case, pixels: int, seed: int) -> AdhesionMap:
    """One realisation; the same surface for every number of pixels."""
    cutoff = case.spectrum.short_cutoff
    n_point, pixel = pixels * case.cutoffs, cutoff / pixels
    rng = np.random.default_rng(np.random.SeedSequence(entropy=seed))
    if case.spectrum.roll_off > cutoff:
        spectrum = case.spectrum.with_elastic_energy(case.rms**2 / 4)
        return rough_adhesion(gaussian_field(spectrum, n_point, n_point * pixel, rng), pixel)
    noise = gaussian_field(case.spectrum, n_point, n_point * pixel, rng)
    return chemical_adhesion(case.rms * noise / np.std(noise), pixel)


def field_of(case: Case, setting: Setting, seed: int) -> TileField:
    """Field of one realisation."""
    cutoff = case.spectrum.short_cutoff
    sites = 2 * math.pi * jkr.equilibrium_radius(1.0) / cutoff * setting.angles
    return contact_field(
        surface(case, setting.pixels, seed),
        2 * round(sites / 2),
        cutoff / setting.samples,
        1.0,
        setting.interpolation,
        band_limited=True,
    )


def branch_adhesion(
    field: TileField, penetrations: Array, direction: int, tolerance: float
) -> float:
    """Mean apparent work of adhesion of one branch at given penetrations."""
    history = FrontHistory(field, np.full(n_angle(field), first_radius(field)), tolerance=tolerance)
    loads = penetrations if direction > 0 else penetrations[::-1]
    sign: Direction = 1 if direction > 0 else -1
    smooth = jkr.equilibrium_radius(float(loads[0]))
    history.begin(forward_circle(field, float(loads[0]), sign, smooth))
    for penetration in loads:
        history.follow(float(penetration), sign)
    return float(np.mean([state.apparent_work_of_adhesion for state in history.states]))


def hysteresis(case: Case, setting: Setting, seed: int) -> tuple[float, float]:
    """w_retr - w_appr of one realisation and the CPU seconds it took, synthesis included."""
    start = time.process_time()
    field = field_of(case, setting, seed)
    appr, retr = (
        branch_adhesion(field, case.penetrations, direction, setting.tolerance)
        for direction in (1, -1)
    )
    return retr - appr, time.process_time() - start


def study(case: Case, families: dict[str, list[Setting]]) -> tuple[list[Row], Row]:
    """Rows of all settings, and that of the finest one."""
    runs = [hysteresis(case, case.finest, seed) for seed in range(N_REALISATION)]
    exact = np.array([value for value, _ in runs])
    scale = float(np.mean(exact))
    finest = Row("finest", case.finest, float(np.mean([s for _, s in runs])), 0.0, 0.0, 0.0)
    click.echo(f"{case.name}: hysteresis {scale:.5g} +- {np.std(exact, ddof=1):.2g} w_int")
    rows = []
    for family, settings in families.items():
        for setting in settings:
            if setting == case.finest:
                continue
            runs = [hysteresis(case, setting, seed) for seed in range(N_REALISATION)]
            errors = (np.array([value for value, _ in runs]) - exact) / scale
            rows.append(
                Row(
                    family,
                    setting,
                    seconds=float(np.mean([seconds for _, seconds in runs])),
                    bias=float(np.mean(errors)),
                    bias_error=float(np.std(errors, ddof=1) / math.sqrt(N_REALISATION)),
                    rms=float(np.sqrt(np.mean(errors**2))),
                )
            )
            click.echo(f"  {setting.label}: {rows[-1].rms:.2%}, {rows[-1].seconds:.2f} s")
    return rows, finest


def table(case: Case, rows: list[Row], finest: Row) -> str:
    """Markdown table of a case."""
    known = case.authors_seconds is not None
    lines = [
        "| varied | setting | CPU s | bias % | rms % |"
        + (" against the authors |" if known else ""),
        "|---|---|---|---|---|" + ("---|" if known else ""),
        f"| | {finest.setting.label} | {finest.seconds:.3g} | reference | |"
        + (" |" if known else ""),
    ]
    for row in rows:
        line = (
            f"| {row.family} | {row.setting.label} | {row.seconds:.3g} "
            f"| {100 * row.bias:+.2f} +- {100 * row.bias_error:.2f} | {100 * row.rms:.2f} |"
        )
        if case.authors_seconds is not None:
            line += f" {case.authors_seconds / row.seconds:.0f} times |"
        lines.append(line)
    return "\n".join(lines)


def against_cycle(case: Case) -> str:
    """Sentences that compare the steady parts with the full cycle, at the chosen numerics."""
    flat = case.spectrum.roll_off == case.spectrum.short_cutoff
    length = correlation_length("chemical" if flat else "roughness", case.spectrum)
    schedule = SteadySchedule(0.3, 1.0, travel=1.5, error=0.2)
    count = 4 * N_REALISATION if case.spectrum.short_cutoff >= 0.02 else N_REALISATION
    values, seconds = np.empty((3, count)), np.empty((2, count))
    for seed in range(count):
        start = time.process_time()
        steady = run_steady(
            field_of(case, CHOSEN, seed),
            schedule,
            correlation_length=length,
            elastic_energy=case.rms**2 / 4,
            tolerance=CHOSEN.tolerance,
        )
        seconds[0, seed] = time.process_time() - start
        start = time.process_time()
        field = field_of(case, CHOSEN, seed)
        cycle = run_cycle(field, LoadSchedule(1.0, 0.05), tolerance=CHOSEN.tolerance)
        seconds[1, seed] = time.process_time() - start
        values[:, seed] = (
            _hysteresis_between(steady, steady, length),
            _hysteresis_between(cycle, steady, length),
            steady_adhesion(cycle, length).hysteresis,
        )
    mean, error = values.mean(axis=1), values.std(axis=1, ddof=1) / math.sqrt(count)
    difference = values[0] - values[1]
    return (
        f"Means of {count} surfaces. Steady parts, from penetration 0.3 until k of w_appr is known "
        f"to 0.2: {mean[0]:.4f} +- {error[0]:.4f} w_int in {seconds[0].mean():.2f} s. Full cycle "
        f"in steps of 0.05: {mean[1]:.4f} +- {error[1]:.4f} between the same penetrations, in "
        f"{seconds[1].mean():.2f} s ({seconds[1].mean() / seconds[0].mean():.1f} times as long); "
        f"difference on the same surfaces {difference.mean():+.4f} +- "
        f"{difference.std(ddof=1) / math.sqrt(count):.4f}. Over all radii of the cycle, larger "
        f"ones too: {mean[2]:.4f} +- {error[2]:.4f}."
    )


def _hysteresis_between(record: CycleRecord, steady: CycleRecord, length: float) -> float:
    """Difference of the branches of a record, each between the loads of its steady part."""
    means = []
    for sign in (-1, 1):
        used = steady.penetration[(steady.direction == sign) & (steady.least_travel >= length)]
        inside = np.abs(record.penetration - np.mean(used[[0, -1]])) <= np.ptp(used) / 2 + 1e-9
        branch = inside & (record.direction == sign)
        means.append(float(np.mean(record.apparent_work_of_adhesion[branch])))
    return means[0] - means[1]


def work_precision(case: Case, rows: list[Row]) -> Figure:
    """Error against CPU time of the settings."""
    with house_style():
        figure = blank_figure(1.45 * COLUMN, 0.85 * COLUMN)
        axes = figure.add_subplot()
        families = dict.fromkeys(row.family for row in rows)
        for family, colour, marker in zip(families, COLOURS, MARKERS, strict=False):
            chosen = [row for row in rows if row.family == family]
            axes.plot(
                [row.seconds for row in chosen],
                [100 * row.rms for row in chosen],
                marker=marker,
                markersize=4,
                linewidth=0.8,
                color=colour,
                label=family,
            )
        axes.axhline(100 * TARGET, color="0.6", linewidth=0.6, dashes=(4, 2))
        axes.set_xscale("log")
        axes.set_yscale("log")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())
        axes.set_xlabel("CPU time of one realisation / s")
        axes.set_ylabel("rms error of the hysteresis / %")
        axes.set_title(case.title)
        figure.legend(loc="outside right upper", title="varied")
        return figure


def dataset(studies: dict[str, list[Row]]) -> xr.Dataset:
    """All rows on one dimension."""
    named = [(name, row) for name, rows in studies.items() for row in rows]

    def column(values: list[float] | list[str], units: str, long_name: str) -> tuple:
        return ("setting", np.array(values), {"units": units, "long_name": long_name})

    settings = [row.setting for _, row in named]
    per_cutoff = "1 / short cutoff"
    return xr.Dataset(
        {
            "case": column([name for name, _ in named], "1", "surface"),
            "family": column([row.family for _, row in named], "1", "knob that is varied"),
            "angles": column([s.angles for s in settings], per_cutoff, "sites of the front"),
            "samples": column([s.samples for s in settings], per_cutoff, "samples along a ray"),
            "interpolation": column([s.interpolation for s in settings], "1", "pieces"),
            "pixels": column([s.pixels for s in settings], per_cutoff, "points of the tile"),
            "tolerance": column([s.tolerance for s in settings], "w_int", "force left"),
            "seconds": column([row.seconds for _, row in named], "s", "CPU time, mean"),
            "bias": column([row.bias for _, row in named], "1", "mean relative error"),
            "bias_error": column([row.bias_error for _, row in named], "1", "its standard error"),
            "rms": column([row.rms for _, row in named], "1", "rms relative error"),
        }
    )


def main() -> None:
    """Run the chosen cases."""
    parser = argparse.ArgumentParser(description="time against error of the hysteresis")
    parser.add_argument("--case", action="append", choices=[case.name for case in CASES])
    parser.add_argument("--only-together", action="store_true", help="leave single knobs out")
    parser.add_argument("--output", type=Path, default=Path("results/benchmark"))
    arguments = parser.parse_args()
    families = FAMILIES
    if arguments.only_together:
        families = {"together": FAMILIES["together"]}
    cases = [case for case in CASES if case.name in (arguments.case or ["flat-0.4", "flat-0.1"])]
    hysteresis(replace(cases[0], cutoffs=8), Setting(1, 3, "cubic", 4, 1e-3), 0)
    parts = ["# Time against error of the hysteresis", "", described_machine(), ""]
    studies = {}
    for case in cases:
        rows, finest = study(case, families)
        studies[case.name] = rows
        parts += [f"## {case.name}", "", table(case, rows, finest), ""]
        if case.spectrum.short_cutoff >= 0.005:
            parts += [against_cycle(case), ""]
        save_figure(work_precision(case, rows), arguments.output / f"hysteresis-{case.name}")
    arguments.output.mkdir(parents=True, exist_ok=True)
    text = "\n".join(parts)
    stem = "hysteresis-" + "-".join(studies)
    (arguments.output / f"{stem}.md").write_text(text, encoding="utf-8")
    write_dataset(arguments.output / f"{stem}.nc", dataset(studies), provenance())
    click.echo(text)


if __name__ == "__main__":
    main()
