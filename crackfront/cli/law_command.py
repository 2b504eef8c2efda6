"""`crackfront law`: the factor k of a straight front, or of a sphere, by the measured law."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.answers import echo_answer
from crackfront.cli.option_types import as_json, examples
from crackfront.core.bounds import LENGTH, check_within

if TYPE_CHECKING:
    from crackfront.analysis.estimate import Estimate
    from crackfront.analysis.law import PinningFactor
    from crackfront.core.adhesion import FieldKind
    from crackfront.core.spectrum import SelfAffineSpectrum

_FRONT, _SPHERE = "--w-rms and --g", "--spectrum, --elastic-energy and --contact-radius"
_ERRORS = ("statistical", "numerical", "model")


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
    from crackfront.analysis.law import pinning_factor, shipped_law, spectral_breadth
    from crackfront.analysis.law_spheres import sphere_factors
    from crackfront.core.adhesion import adhesion_rms

    front, sphere = (w_rms, g), (spectrum, elastic_energy, contact_radius)
    names_front = any(item is not None for item in (*front, breadth))
    if names_front and any(item is not None for item in sphere):
        raise ValueError(
            f"options of a front ({_FRONT}) and a sphere ({_SPHERE}) are mixed; name either of them"
        )
    if w_rms is not None and g is not None:
        factor = pinning_factor(w_rms, g, field, breadth)
        # JSON lacks infinity.
        inputs: dict[str, Any] = {"w_rms": w_rms, "g": g if math.isfinite(g) else "inf"}
        inputs |= {} if breadth is None else {"breadth": breadth}
        size, shape = g, breadth
        entries = _entries(factor.factor, factor, factor, inputs, factor.warning)
    elif spectrum is not None and elastic_energy is not None and contact_radius is not None:
        factors = sphere_factors(field, _shape(spectrum), elastic_energy, contact_radius)
        size, shape = factors.size, spectral_breadth(field, _shape(spectrum))
        inputs = {"w_rms": adhesion_rms(elastic_energy), "l_kappa": factors.spring}
        inputs |= {"larkin_length": factors.larkin_length, "g": factors.size}
        entries = _entries(
            factors.both, factors.approach, factors.retraction, inputs, factors.warning
        )
    else:
        raise ValueError(f"the options are incomplete; name {_FRONT}, or else {_SPHERE}")
    departures = [departure.sentence for departure in shipped_law().departures_at(size, shape)]
    entries |= {
        "departures": departures,
        "measured": {"w_rms": shipped_law().disorder, "g": shipped_law().size},
    }
    echo_answer(entries, _lines(entries), as_json=as_json)


def _entries(
    k: Estimate[float],
    appr: PinningFactor,
    retr: PinningFactor,
    inputs: dict[str, Any],
    warning: str,
) -> dict[str, Any]:
    """What is known of k and of its branches at a disorder and a size, for JSON."""
    errors = {name: (getattr(appr, name) + getattr(retr, name)) / 2 for name in _ERRORS}
    return {
        "k": k.value,
        "k_low": k.low,
        "k_high": k.high,
        "k_appr": appr.factor.value,
        "k_retr": retr.factor.value,
        **inputs,
        **errors,
        "negative_share": appr.negative_share,
        "warning": warning,
    }


def _lines(entries: dict[str, Any]) -> Iterator[str]:
    """Lines of what is known of k."""
    interval = f"{entries['k_low']:.3g} to {entries['k_high']:.3g}"
    yield f"k              {entries['k']:.3f} (95%: {interval})"
    errors = ", ".join(f"{name} {entries[name]:.2g}" for name in _ERRORS)
    yield (
        f"               approach {entries['k_appr']:.3f}, retraction {entries['k_retr']:.3f}; "
        f"standard errors: {errors}"
    )
    size = f"g {float(entries['g']):.3g}"
    if "l_kappa" in entries:
        size += f" = L_kappa {entries['l_kappa']:.3g} / Larkin {entries['larkin_length']:.3g}"
    if "breadth" in entries:
        size += f", breadth {entries['breadth']:.3g}"
    yield f"at             w_rms {entries['w_rms']:.3g} w_int, {size}"
    ranges = (
        f"{name} {low:.3g} to {high:.3g}" for name, (low, high) in entries["measured"].items()
    )
    yield f"measured for   {', '.join(ranges)}"
    for sentence in entries["departures"]:
        yield f"measured k     above the law: {sentence}"
    yield f"negative w_loc {entries['negative_share']:.2%} of the surface"
    if entries["warning"]:
        yield f"beyond what was measured: {entries['warning']}"


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
