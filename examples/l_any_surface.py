"""
k of surfaces of any kind
=========================

Three sweeps, each with surfaces of one e_el that differ in one respect: the shape of the spectrum,
the stretch of the spectrum along one direction, or the skewness of the heights. The tables are
``hysteresis.nc`` of ``make SWEEP=config/bandpass.yaml``, ``anisotropic.yaml`` and ``skewed.yaml``,
as stored in ``docs/reference``.
"""

import sys
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import pyplot
from scipy import stats

reference = Path(sys.argv[0]).parents[1] / "docs/reference"
QUESTIONS = {
    "bandpass": ("shape", {"fractal": "self-affine", "band": "two octaves"}),
    "anisotropic": ("anisotropy", {"isotropic": "1", "ratio2": "2", "ratio4": "4"}),
    "skewed": ("skewness", {"pits-L30": "−1", "gaussian-L30": "0", "peaks-L30": "+1"}),
}

# %%
# Every simulation gives a k. The interval of a mean over realisations is Student's t.


def factors(name):
    """Mean k of each spectrum and amplitude, and half of its 95% interval."""
    table = xr.open_dataset(reference / f"{name}.nc")
    k = table.hysteresis / (2 * table.e_el)
    n = table.sizes["realisation"]
    half_width = k.std("realisation", ddof=1) * stats.t.ppf(0.975, n - 1) / np.sqrt(n)
    return k.mean("realisation"), half_width


# %%
# Anisotropy lowers k most; skewness changes it by a few percent.

figure, panels = pyplot.subplots(1, 3, layout="constrained", figsize=(8, 3), dpi=150, sharey=True)
for axes, (name, (question, labels)) in zip(panels, QUESTIONS.items(), strict=True):
    mean, half_width = factors(name)
    places = np.arange(len(labels))
    for index, energy in enumerate(mean.amplitude.values):
        points, bars = mean.sel(amplitude=energy), half_width.sel(amplitude=energy)
        label = rf"$e_\mathrm{{el}} = {energy:g}\,w_\mathrm{{int}}$"
        shifted = places + 0.1 * (index - 0.5)
        axes.errorbar(shifted, points, bars, fmt="o", color=f"C{index}", capsize=3, label=label)
        print(f"{question}, e_el {energy:g}:")
        for spectrum, text in labels.items():
            value, bar = points.sel(spectrum=spectrum), bars.sel(spectrum=spectrum)
            print(f"  {text}: {value.item():.2f} ± {bar.item():.2f}")
    axes.set_xticks(places, labels.values())
    axes.set_xlim(-0.5, len(labels) - 0.5)
    axes.set_xlabel(question)
    axes.legend(loc="lower left")
for letter, axes in zip("abc", panels, strict=True):
    axes.set_title(letter, loc="left", fontweight="bold")
panels[0].set_ylim(bottom=0)
label = panels[0].set_ylabel(r"$k = (w_\mathrm{retr} - w_\mathrm{appr})\,/\,2 e_\mathrm{el}$")
