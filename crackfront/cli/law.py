"""`crackfront law`: the factor k of a straight front, or of a sphere, by the measured law."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.report import as_json, echo_json, examples
from crackfront.data.bounds import LENGTH, refuse_outside

if TYPE_CHECKING:
    from crackfront.core.adhesion import FieldKind
    from crackfront.core.spectrum import SelfAffineSpectrum

_FRONT, _SPHERE = ("--w-rms", "--g"), ("--spectrum", "--elastic-energy", "--contact-radius")


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
    "--spectrum",
    help="Sphere: short cutoff, roll-off and Hurst exponent, as in 0.005,0.1,0.3; reduced lengths.",
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
    spectrum: str | None,
    elastic_energy: float | None,
    contact_radius: float | None,
    field: FieldKind,
    as_json: bool,
) -> None:
    """Print the factor k by the law that was measured on straight fronts.

    Either of a straight front on springs (--w-rms, --g), or of a sphere (--spectrum,
    --elastic-energy, --contact-radius), whose edge is held as such a front is. Works of adhesion
    are then w_int - e_el -+ k e_el.
    """
    front, sphere = (w_rms, g), (spectrum, elastic_energy, contact_radius)
    if any(item is not None for item in front) and any(item is not None for item in sphere):
        raise ValueError(
            f"options of a front ({_named(_FRONT)}) and of a sphere ({_named(_SPHERE)}) are mixed; "
            "name those of one"
        )
    if w_rms is not None and g is not None:
        entries = _front_entries(field, w_rms, g)
    elif spectrum is not None and elastic_energy is not None and contact_radius is not None:
        entries = _sphere_entries(field, _shape(spectrum), elastic_energy, contact_radius)
    else:
        raise ValueError(
            f"the options are incomplete; name {_named(_FRONT)}, or else {_named(_SPHERE)}"
        )
    entries |= {"measured": _measured()}
    if as_json:
        echo_json(entries)
    else:
        _echo_text(entries)


def _front_entries(field: FieldKind, w_rms: float, g: float) -> dict[str, Any]:
    """What is known of k of a straight front."""
    from crackfront.analysis.law import pinning_factor

    found = pinning_factor(w_rms, g, field)
    k = found.factor
    return {
        "k": k.value,
        "k_low": k.low,
        "k_high": k.high,
        "k_appr": k.value,
        "k_retr": k.value,
        "w_rms": w_rms,
        # JSON has no infinity.
        "g": g if math.isfinite(g) else "inf",
        "statistical": found.statistical,
        "numerical": found.numerical,
        "model": found.model,
        "negative_share": found.negative_share,
        "warning": found.warning,
    }


def _sphere_entries(
    field: FieldKind, spectrum: SelfAffineSpectrum, elastic_energy: float, contact_radius: float
) -> dict[str, Any]:
    """What is known of k of a sphere."""
    from crackfront.analysis.law_spheres import sphere_factors

    found = sphere_factors(field, spectrum, elastic_energy, contact_radius)
    appr, retr, k = found.approach, found.retraction, found.both
    errors = {
        name: (getattr(appr, name) + getattr(retr, name)) / 2
        for name in ("statistical", "numerical", "model")
    }
    return {
        "k": k.value,
        "k_low": k.low,
        "k_high": k.high,
        "k_appr": appr.factor.value,
        "k_retr": retr.factor.value,
        "w_rms": 2 * math.sqrt(elastic_energy),
        "l_kappa": found.spring,
        "larkin_length": found.larkin_length,
        "g": found.size,
        **errors,
        "negative_share": appr.negative_share,
        "warning": found.warning,
    }


def _measured() -> dict[str, tuple[float, float]]:
    """Ranges of what the law was fitted to."""
    from crackfront.analysis.law import shipped_law

    return {"w_rms": shipped_law().disorder, "g": shipped_law().size}


def _echo_text(entries: dict[str, Any]) -> None:
    """Print what is known of k in lines."""
    interval = f"{entries['k_low']:.3g} to {entries['k_high']:.3g}"
    click.echo(f"k              {entries['k']:.3f} (95%: {interval})")
    click.echo(
        f"               approach {entries['k_appr']:.3f}, retraction {entries['k_retr']:.3f}; "
        "standard errors: "
        + ", ".join(f"{name} {entries[name]:.2g}" for name in ("statistical", "numerical", "model"))
    )
    size = f"g {float(entries['g']):.3g}"
    if "l_kappa" in entries:
        size += f" = L_kappa {entries['l_kappa']:.3g} / Larkin {entries['larkin_length']:.3g}"
    click.echo(f"at             w_rms {entries['w_rms']:.3g} w_int, {size}")
    ranges = (
        f"{name} {low:.3g} to {high:.3g}" for name, (low, high) in entries["measured"].items()
    )
    click.echo(f"measured for   {', '.join(ranges)}")
    click.echo(f"negative w_loc {entries['negative_share']:.2%} of the surface")
    if entries["warning"]:
        click.echo(f"beyond what was measured: {entries['warning']}")


def _shape(text: str) -> SelfAffineSpectrum:
    """Spectrum that an option like 0.005,0.1,0.3 names."""
    from crackfront.core.spectrum import SelfAffineSpectrum

    try:
        short_cutoff, roll_off, hurst = (float(part) for part in text.split(","))
    except ValueError as error:
        raise ValueError(
            f"--spectrum is {text!r}; write short cutoff, roll-off and Hurst exponent, as in "
            "0.005,0.1,0.3"
        ) from error
    for length in (short_cutoff, roll_off):
        refuse_outside("--spectrum: a wavelength", length, LENGTH)
    return SelfAffineSpectrum(short_cutoff, roll_off, hurst)


def _named(options: tuple[str, ...]) -> str:
    """Options in a sentence."""
    return f"{', '.join(options[:-1])} and {options[-1]}"
