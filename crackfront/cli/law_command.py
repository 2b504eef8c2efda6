"""`crackfront law`: the factor k of a straight front, or of a sphere, by the measured law."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.answers import echo_answer
from crackfront.cli.option_types import as_json, examples
from crackfront.core.bounds import LENGTH, check_within

if TYPE_CHECKING:
    from crackfront.analysis.estimate import Estimate
    from crackfront.analysis.law import Departure, PinningFactor
    from crackfront.core.adhesion import FieldKind
    from crackfront.core.spectrum import SelfAffineSpectrum

_FRONT, _SPHERE = "--w-rms and --g", "--spectrum, --elastic-energy and --contact-radius"


@click.command(
    epilog=examples(
        "crackfront law --w-rms 0.4 --g inf",
        "crackfront law --spectrum 0.005,0.1,0.3 --elastic-energy 0.05 --contact-radius 1.9 --json",
    )
)
@click.option("--w-rms", type=float, help="Front: rms of the local work of adhesion, in w_int.")
@click.option(
    "--g", type=float, help="Front: length of its springs over the Larkin length, or inf."
)
@click.option(
    "--breadth",
    type=float,
    help="Front: breadth of the spectrum of w_loc, in e-folds; by default k covers all breadths.",
)
@click.option(
    "--spectrum",
    help="Sphere: short cutoff, roll-off and Hurst exponent, as in 0.005,0.1,0.3, or the cutoff of "
    "a flat spectrum; reduced lengths.",
)
@click.option("--elastic-energy", type=float, help="Sphere: e_el, in w_int.")
@click.option("--contact-radius", type=float, help="Sphere: radius of the contact, reduced.")
@click.option(
    "--field",
    type=click.Choice(["roughness", "chemical"]),
    default="roughness",
    show_default=True,
    help="What makes the local work of adhesion vary.",
)
@as_json
def law(
    w_rms: float | None,
    g: float | None,
    breadth: float | None,
    spectrum: str | None,
    elastic_energy: float | None,
    contact_radius: float | None,
    field: FieldKind,
    as_json: bool,
) -> None:
    """Print the factor k by the law that was measured on straight fronts.

    Give --w-rms and --g for a straight front on springs, or --spectrum, --elastic-energy and
    --contact-radius for a sphere, whose edge the contact restores as springs do. Works of adhesion
    are w_int - e_el -+ k e_el.
    """
    from crackfront.analysis.law import shipped_law

    front_options = w_rms, g, breadth
    sphere_options = spectrum, elastic_energy, contact_radius
    if any(value is not None for value in front_options) and any(
        value is not None for value in sphere_options
    ):
        raise ValueError(
            f"options of a front ({_FRONT}) and a sphere ({_SPHERE}) are mixed; name either of them"
        )
    if w_rms is not None and g is not None:
        answer = _front_answer(w_rms, g, breadth, field)
    elif spectrum is not None and elastic_energy is not None and contact_radius is not None:
        answer = _sphere_answer(_shape(spectrum), elastic_energy, contact_radius, field)
    else:
        raise ValueError(f"the options are incomplete; name {_FRONT}, or else {_SPHERE}")
    ranges = {"w_rms": shipped_law().disorder, "g": shipped_law().size}
    content = answer.content | {"measured": ranges}
    echo_answer(content, answer.lines(ranges), as_json=as_json)


def _front_answer(w_rms: float, g: float, breadth: float | None, field: FieldKind) -> LawAnswer:
    """Answer for a straight front on springs."""
    from crackfront.analysis.law import pinning_factor, shipped_law

    factor = pinning_factor(w_rms, g, field, breadth)
    return LawAnswer(
        k=factor.factor,
        approach=factor,
        retraction=factor,
        w_rms=w_rms,
        g=g,
        breadth=breadth,
        departures=shipped_law().departures_at(g, breadth),
    )


def _sphere_answer(
    spectrum: SelfAffineSpectrum, elastic_energy: float, contact_radius: float, field: FieldKind
) -> LawAnswer:
    """Answer for a sphere on a random surface."""
    from crackfront.analysis.law import shipped_law, spectral_breadth
    from crackfront.analysis.law_spheres import sphere_factors
    from crackfront.core.adhesion import adhesion_rms

    factors = sphere_factors(field, spectrum, elastic_energy, contact_radius)
    breadth = spectral_breadth(field, spectrum)
    return LawAnswer(
        k=factors.both,
        approach=factors.approach,
        retraction=factors.retraction,
        w_rms=adhesion_rms(elastic_energy),
        l_kappa=factors.spring,
        larkin_length=factors.larkin_length,
        g=factors.size,
        departures=shipped_law().departures_at(factors.size, breadth),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class LawAnswer:
    """k of a front, or of a sphere with its lengths, as the command prints it."""

    k: Estimate[float]
    """Mean of both branches."""
    approach: PinningFactor
    """k of the approach; for a front the same as in retraction."""
    retraction: PinningFactor
    """k of the retraction."""
    w_rms: float
    """(Units: w_int)"""
    g: float
    """Length of the springs over the Larkin length."""
    l_kappa: float | None = None
    """None for a front, which only the ratio g describes. (Units: reduced lateral length)"""
    larkin_length: float | None = None
    """None for a front. (Units: reduced lateral length)"""
    breadth: float | None = None
    """Breadth of the spectrum of w_loc that a front was asked for, in e-folds."""
    departures: Sequence[Departure]
    """Known departures of measured k from the law, for fronts of this size and breadth."""

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors of k by their origin, means of both branches."""
        branches = self.approach, self.retraction
        return {
            "statistical": sum(branch.statistical for branch in branches) / 2,
            "numerical": sum(branch.numerical for branch in branches) / 2,
            "model": sum(branch.model for branch in branches) / 2,
        }

    @property
    def warning(self) -> str:
        """Sentences on numbers outside the measured ranges; empty inside."""
        return self.approach.warning or self.retraction.warning

    @property
    def content(self) -> dict[str, Any]:
        """Keys and values for JSON; a front lacks lengths, a sphere a breadth."""
        inputs = {
            "w_rms": self.w_rms,
            "l_kappa": self.l_kappa,
            "larkin_length": self.larkin_length,
            "g": self.g if math.isfinite(self.g) else "inf",  # JSON lacks infinity
            "breadth": self.breadth,
        }
        return {
            "k": self.k.value,
            "k_low": self.k.low,
            "k_high": self.k.high,
            "k_appr": self.approach.factor.value,
            "k_retr": self.retraction.factor.value,
            **{name: value for name, value in inputs.items() if value is not None},
            **self.errors,
            "negative_share": self.approach.negative_share,
            "warning": self.warning,
            "departures": [departure.sentence for departure in self.departures],
        }

    def lines(self, ranges: Mapping[str, tuple[float, float]]) -> Iterator[str]:
        """Lines for people; `ranges` are those in which k was measured."""
        yield f"k              {self.k.value:.3f} (95%: {self.k.low:.3g} to {self.k.high:.3g})"
        errors = ", ".join(f"{name} {error:.2g}" for name, error in self.errors.items())
        yield (
            f"               approach {self.approach.factor.value:.3f}, "
            f"retraction {self.retraction.factor.value:.3f}; standard errors: {errors}"
        )
        size = f"g {self.g:.3g}"
        if self.l_kappa is not None:
            size += f" = L_kappa {self.l_kappa:.3g} / Larkin {self.larkin_length:.3g}"
        if self.breadth is not None:
            size += f", breadth {self.breadth:.3g}"
        yield f"at             w_rms {self.w_rms:.3g} w_int, {size}"
        measured = (f"{name} {low:.3g} to {high:.3g}" for name, (low, high) in ranges.items())
        yield f"measured for   {', '.join(measured)}"
        for departure in self.departures:
            yield f"measured k     above the law: {departure.sentence}"
        yield f"negative w_loc {self.approach.negative_share:.2%} of the surface"
        if self.warning:
            yield f"beyond what was measured: {self.warning}"


def _shape(text: str) -> SelfAffineSpectrum:
    """Spectrum that an option like 0.005,0.1,0.3, or 0.005 for a flat one, names."""
    from crackfront.core.spectrum import SelfAffineSpectrum

    try:
        numbers = [float(part) for part in text.split(",")]
        if len(numbers) == 1:  # flat, whatever the Hurst exponent
            numbers = [numbers[0], numbers[0], 1.0]
        short_cutoff, roll_off, hurst = numbers
    except ValueError as error:
        raise ValueError(
            f"--spectrum is {text!r}; write short cutoff, roll-off and Hurst exponent, as in "
            "0.005,0.1,0.3, or the cutoff of a flat spectrum"
        ) from error
    for length in (short_cutoff, roll_off):
        check_within("--spectrum: a wavelength", length, LENGTH)
    return SelfAffineSpectrum(short_cutoff, roll_off, hurst)
