"""The measured hysteresis on nanodiamond against the paper, the front and boundary elements."""

from __future__ import annotations

import math
from dataclasses import dataclass

from matplotlib.figure import Figure

from crackfront.analysis.estimate import REACH, Estimate
from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.validity import front_excess
from crackfront.plots.style import BLACK, BLUE, COLUMN, GREEN, VERMILION, blank_figure, house_style
from studies.canaries import interval_number
from studies.numbers import Number
from studies.paper.main_5bc import MEASURED, widest_instability_estimate
from studies.paper.nanodiamond import NanodiamondContact
from studies.tables import Table, interval_header, make_table


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """One hysteresis of the rubber sphere on nanodiamond."""

    name: str
    value: Estimate[float]
    """With its 95% interval, NaN where none is known. (Units: J / m^2)"""
    colour: str

    def cells(self) -> tuple[str, ...]:
        """Value, low and high end of the interval in mJ/m2; empty where they are not known."""
        numbers = (self.value.value, self.value.low, self.value.high)
        return tuple(f"{1e3 * number:.0f}" if math.isfinite(number) else "" for number in numbers)


def hystereses(contact: NanodiamondContact) -> tuple[Hysteresis, ...]:
    """What was measured, and what theory and simulation say, from the data of Fig. 5b."""
    unknown = math.nan
    by_paper = 2 * PAPER_FACTOR * contact.whole_elastic_energy
    front = float(contact.retraction[0] - contact.approach[0])
    error = math.hypot(contact.approach[1], contact.retraction[1])
    ratio = front_excess(contact.elastic_energy / contact.work_of_adhesion, contact.law.size).ratio
    below = Estimate(front / ratio.value, unknown, front / ratio.high, front / ratio.low)
    return (
        Hysteresis("measured", Estimate(MEASURED, unknown, unknown, unknown), BLACK),
        Hysteresis("paper, k = 3", Estimate(by_paper, unknown, unknown, unknown), GREEN),
        Hysteresis(
            "front, simulated",
            Estimate(front, error, front - REACH * error, front + REACH * error),
            BLUE,
        ),
        Hysteresis("front, divided by its ratio\nto boundary elements", below, VERMILION),
    )


def hystereses_table(shown: tuple[Hysteresis, ...]) -> Table:
    """Each hysteresis, and the measured one over it."""
    measured = shown[0].value.value
    rows = [
        (
            " ".join(hysteresis.name.split()),
            *hysteresis.cells(),
            f"{measured / hysteresis.value.value:.1f}",
        )
        for hysteresis in shown
    ]
    columns = interval_header("hysteresis mJ/m2")
    return make_table(f"nanodiamond | {columns} | measured / this", rows)


def hystereses_numbers(shown: tuple[Hysteresis, ...]) -> dict[str, Number]:
    """Hysteresis of the front and of the prediction, and the measured one over the latter."""
    measured, _, front, prediction = (hysteresis.value for hysteresis in shown)
    reach = (prediction.high - prediction.low) / 2
    ratio = measured.value / prediction.value
    ratio_reach = measured.value * (1 / prediction.low - 1 / prediction.high) / 2
    unit = "mJ/m2"
    return {
        "nanodiamond, front": Number(1e3 * front.value, 1e3 * (front.high - front.value), unit),
        "nanodiamond, prediction": Number(1e3 * prediction.value, 1e3 * reach, unit),
        "nanodiamond, measured over prediction": Number(ratio, ratio_reach),
    }


def instability_numbers(contact: NanodiamondContact) -> dict[str, Number]:
    """Widest single instability of an approach on nanodiamond."""
    widest = widest_instability_estimate(contact)
    return {"nanodiamond, widest instability": interval_number(widest, "um")}


def hystereses_figure(shown: tuple[Hysteresis, ...]) -> Figure:
    """Each hysteresis with its interval, the measured one as a line through all."""
    with house_style():
        figure = blank_figure(COLUMN, 0.42 * COLUMN)
        axes = figure.subplots()
        axes.axvline(1e3 * shown[0].value.value, color=BLACK, linewidth=0.7, dashes=(4, 2))
        for place, hysteresis in enumerate(shown):
            axes.hlines(
                place,
                1e3 * hysteresis.value.low,
                1e3 * hysteresis.value.high,
                color=hysteresis.colour,
                linewidth=2,
            )
            axes.plot(1e3 * hysteresis.value.value, place, "o", color=hysteresis.colour)
        axes.set_yticks(range(len(shown)), [hysteresis.name for hysteresis in shown])
        axes.set_ylim(len(shown) - 0.5, -0.5)
        axes.set_xlim(0, 100)
        axes.set_xlabel(r"hysteresis $w_\mathrm{retr} - w_\mathrm{appr}$ (mJ m$^{-2}$)")
    return figure
