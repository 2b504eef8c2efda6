"""What each request costs, measured on a small scene."""

import pytest

from studies.speed import needs


@pytest.fixture(scope="module")
def requests():
    """What each request costs in a small scene, by its name."""
    return {need.name: needs.measured(needs.SMALL, need) for need in needs.NEEDS}


def test_asking_for_less_holds_and_stores_less(requests):
    for less, more in (
        ("hysteresis", "cycle"),
        ("cycle", "cycle, energies"),
        ("cycle, energies", "cycle, fronts"),
        ("cycle, fronts", "cycle, fronts, energies"),
    ):
        assert requests[less].record < requests[more].record, more
        assert requests[less].file < requests[more].file, more
    assert requests["rings"].record == requests["rings as a front"].record
    assert requests["rings"].field < requests["rings as a front"].field / 100
    assert requests["rings"].field + requests["rings"].record < requests["cycle"].field


def test_the_hysteresis_alone_crosses_less_of_the_field_in_fewer_steps(requests):
    alone, cycle, rings = (requests[name] for name in ("hysteresis", "cycle", "rings"))
    assert (alone.status, cycle.status, rings.status) == ("steady", "lost_contact", "lost_contact")
    assert alone.n_step < cycle.n_step
    assert alone.samples < 0.7 * cycle.samples
    # Out from the centre and back: two radii of about 1.8 at 16 samples a period of 0.2.
    assert rings.samples == pytest.approx(2 * 1.8 / 0.2 * 16, rel=0.1)
