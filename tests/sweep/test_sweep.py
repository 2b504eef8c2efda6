"""Sweeps: their simulations, and that additions leave the others alone."""

from dataclasses import replace
from pathlib import Path

import pytest

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.requests import fit_request, table_request
from crackfront.sweep.sweep import NamedSpectrum

SWEEP = load_sweep(Path(__file__).parents[2] / "config/test.yaml")


def stems(sweep):
    """Names of all simulations."""
    return {simulation.stem for simulation in sweep.simulations()}


def test_additions_and_order_leave_all_other_simulations_as_they_are():
    before = stems(SWEEP)
    new = NamedSpectrum("new", SelfAffineSpectrum(0.3, 0.3, 1.0))
    additions = (
        replace(SWEEP, n_realisation=5),
        replace(SWEEP, elastic_energies=(0.5, *SWEEP.elastic_energies)),
        replace(SWEEP, spectra=(new, *SWEEP.spectra)),
    )
    assert all(before < stems(sweep) for sweep in additions)
    assert stems(replace(SWEEP, spectra=SWEEP.spectra[::-1])) == before


@pytest.mark.parametrize("name", ["lowest_elastic_energy", "highest_elastic_energy", "n_bootstrap"])
def test_another_fit_is_another_request_of_the_same_table(name):
    changed = replace(SWEEP, fit=replace(SWEEP.fit, **{name: 2 * getattr(SWEEP.fit, name)}))
    assert fit_request(changed) != fit_request(SWEEP)
    assert table_request(changed) == table_request(SWEEP)


@pytest.mark.parametrize("block", [None, 1, 3, 10, 11])
def test_shards_hold_every_simulation_once(block):
    sweep = replace(SWEEP, n_realisation=10)
    shards = sweep.shards(block)
    assert len(shards) == 2 * {None: 1, 1: 10, 3: 4, 10: 1, 11: 1}[block]
    assert len({shard.name for shard in shards}) == len(shards)
    parts = [sweep.simulations(shard.item, shard.realisations) for shard in shards]
    keys = [item.key for part in parts for item in part]
    assert sorted(keys) == sorted(item.key for item in sweep.simulations())


def test_a_hundred_thousand_simulations_are_no_more_than_a_thousand_jobs():
    sweep = replace(SWEEP, n_realisation=25_000)
    with pytest.raises(ValueError, match=r"2500 shards, more than 1000 jobs; use blocks of 50 or"):
        sweep.shards(20)
    assert len(sweep.shards(50)) == 1000


@pytest.mark.parametrize("block", [0, -1, "many"])
def test_a_block_that_is_no_number_of_realisations_is_refused(block):
    with pytest.raises(ValueError, match="it must be 1 or more of them"):
        SWEEP.shards(block)
