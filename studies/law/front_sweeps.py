"""Configurations of the fronts of the law of k: config/line.yaml, and what the others change."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.section import yaml_mapping
from crackfront.sweep.sweep import Sweep

_BASE = Path(__file__).parents[2] / "config/line.yaml"
_CHANGES = Path(__file__).with_suffix(".yaml")


def write_configurations(folder: Path) -> list[Path]:
    """Write `<name>.yaml` for each sweep of the law other than config/line.yaml; their paths."""
    base = yaml_mapping(_BASE)
    writer = YAML(typ="safe", pure=True)
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, changes in yaml_mapping(_CHANGES).items():
        paths.append(folder / f"{name}.yaml")
        writer.dump(_configuration(base, changes), paths[-1])
    return paths


def front_sweeps(folder: Path) -> dict[str, Sweep]:
    """Sweeps of the law other than config/line.yaml by name; writes their configurations."""
    return {path.stem: load_sweep(path) for path in write_configurations(folder)}


def _configuration(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Content of a configuration; names of spectra are replaced by the spectra of the base."""
    configuration = _updated(base, changes)
    named = {spectrum["name"]: spectrum for spectrum in base["spectra"]}
    configuration["spectra"] = [
        named[spectrum] if isinstance(spectrum, str) else spectrum
        for spectrum in configuration["spectra"]
    ]
    return configuration


def _updated(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Sections of a base with some keys changed, section by section."""
    updated = dict(base)
    for key, value in changes.items():
        updated[key] = _updated(base[key], value) if isinstance(value, Mapping) else value
    return updated
