"""What each stage of a sweep was asked for: small texts, by whose names and dates rules run again.

`requests/<stage>-<digest>.txt` is an input of the rule of its stage. Another configuration asks for
another text, hence for another file, which is newer than what the stage made before; the file of
the earlier request is removed. So results belong to a configuration whatever Snakemake remembers.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.sweep.sweep import NamedSpectrum, Shard, Sweep

FOLDER = "requests"
"""Folder of the requests among results."""

REQUEST = "request"
"""Attribute of a file: the digest of what it was asked for."""

_DIGITS = 12


@dataclass(frozen=True, slots=True)
class Request:
    """What one stage is asked for."""

    stage: str
    """Name of the stage: `shard-<name>`, `table`, `fit`, or a figure."""
    text: str

    @property
    def digest(self) -> str:
        """Twelve hexadecimal digits of the SHA-256 of the text."""
        return hashlib.sha256(self.text.encode()).hexdigest()[:_DIGITS]

    @property
    def name(self) -> str:
        """Name of the file."""
        return f"{self.stage}-{self.digest}.txt"

    @property
    def siblings(self) -> str:
        """Pattern of the names of the files of this stage, whatever was asked for."""
        return f"{self.stage}-{'?' * _DIGITS}.txt"


def shard_request(sweep: Sweep, shard: Shard) -> Request:
    """Request of the rows of a shard."""
    limit = sweep.numerics.max_sweeps
    lines = [
        f"rows of {shard.item.name}, realisations {shard.realisations[0]} to "
        f"{shard.realisations[-1]}",
        f"version {PHYSICS_VERSION} of the physics, {ROWS_VERSION} of rows, {limit} sweeps at most",
        *_series_lines(sweep, shard.item),
    ]
    return Request(f"shard-{shard.name}", _joined(lines))


def table_request(sweep: Sweep) -> Request:
    """Request of the table of a sweep."""
    lines = [
        f"table of {sweep.n_realisation} realisations of {len(sweep.spectra)} spectra",
        f"version {PHYSICS_VERSION} of the physics, {ROWS_VERSION} of rows, "
        f"{sweep.numerics.max_sweeps} sweeps at most",
        f"at most {sweep.failed_fraction:g} of them without a value, scales {sweep.scales}",
    ]
    for item in sweep.spectra:
        lines += [f"spectrum {item.name}", *_series_lines(sweep, item)]
    return Request("table", _joined(lines))


def fit_request(sweep: Sweep) -> Request:
    """Request of the fit of a sweep, and of its figures and page."""
    fit = sweep.fit
    lines = [
        f"fit of {table_request(sweep).name}",
        f"e_el from {fit.lowest_elastic_energy:.12g} to {fit.highest_elastic_energy:.12g}",
        f"{fit.n_bootstrap} bootstrap samples with seed {sweep.seed}",
    ]
    return Request("fit", _joined(lines))


def _series_lines(sweep: Sweep, item: NamedSpectrum) -> list[str]:
    """A line for the simulations of each amplitude of a spectrum."""
    return [
        f"{series} e_el {elastic_energy:.12g}"
        for series, elastic_energy in zip(sweep.series(item), sweep.elastic_energies, strict=True)
    ]


def _joined(lines: list[str]) -> str:
    """Text of lines."""
    return "\n".join(lines) + "\n"
