"""Files of a fit: arrays with units as netCDF and JSON, and the table that a person reads."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import xarray as xr

from crackfront.analysis.finding import PAPER_FACTOR, PERTURBATION_FACTOR
from crackfront.analysis.fit_text import fit_notes, fit_table
from crackfront.analysis.result import SweepFit, fit_columns
from crackfront.analysis.steady_adhesion import STEADY_DEFINITION
from crackfront.analysis.sweep_fit import FIT_DEFINITION
from crackfront.simulate.jsonable import to_jsonable
from crackfront.simulate.labels import labelled
from crackfront.simulate.provenance import Provenance, utc_now
from crackfront.simulate.storage import write_derived, write_text
from crackfront.sweep.requests import REQUEST


def write_fit(
    folder: Path, fit: SweepFit, request: str, origin: Provenance
) -> tuple[Path, Path, Path]:
    """Write `fit.nc`, `fit.json` and `fit.md`; the first two state the digest of their request."""
    paths = folder / "fit.nc", folder / "fit.json", folder / "fit.md"
    about = {
        "title": f"fit of adhesion hysteresis, {fit.kind}",
        "definition": FIT_DEFINITION,
        "steady_definition": STEADY_DEFINITION,
        "lowest_elastic_energy": fit.lowest_elastic_energy,
        "highest_elastic_energy": fit.highest_elastic_energy,
        "n_bootstrap": fit.n_bootstrap,
        "seed": fit.seed,
        REQUEST: request,
        "factor_of_the_paper": PAPER_FACTOR,
        "factor_of_perturbation_theory": PERTURBATION_FACTOR,
    }
    columns = {item.name: labelled(item, values) for item, values in fit_columns(fit)}
    write_derived(paths[0], xr.Dataset(columns, attrs=about), origin)
    entries = {
        name: {"dims": dims, "values": to_jsonable(values), **attributes}
        for name, (dims, values, attributes) in columns.items()
    }
    content = {
        "about": about,
        "origin": asdict(origin) | {"date": utc_now()},
        "notes": list(fit_notes(fit)),
        "columns": entries,
    }
    write_text(paths[1], json.dumps(content, indent=1, allow_nan=False) + "\n")
    write_text(paths[2], fit_table(fit))
    return paths
