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


def test_fronts_are_the_only_large_part_of_a_record(requests):
    full = requests["cycle, fronts"]
    fronts = 8e-6 * full.n_step * full.n_angle
    assert full.record - requests["cycle"].record == pytest.approx(fronts, rel=1e-12)
    assert fronts > 5 * requests["cycle, energies"].record


def test_the_hysteresis_alone_crosses_less_of_the_field_in_fewer_steps(requests):
    alone, cycle, rings = (requests[name] for name in ("hysteresis", "cycle", "rings"))
    assert (alone.status, cycle.status, rings.status) == ("steady", "lost_contact", "lost_contact")
    assert alone.n_step < cycle.n_step
    assert alone.samples < 0.7 * cycle.samples
    # Out from the centre and back: two radii of about 1.8 at 16 samples a period of 0.2.
    assert rings.samples == pytest.approx(2 * 1.8 / 0.2 * 16, rel=0.1)


def test_the_page_of_requests_lists_them_all(requests):
    page = "\n".join(needs.sections(list(requests.values())))
    assert all(f"| {need.name} |" in page and need.asked in page for need in needs.NEEDS)
