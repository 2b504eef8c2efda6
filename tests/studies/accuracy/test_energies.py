"""e_el of synthetic scans: what predictions from large maps take."""

import pytest

from studies.accuracy.energies import speeds


@pytest.mark.slow
def test_ten_large_maps_take_less_than_15_s_of_one_core():
    found = list(speeds())
    assert [one.figure for one in found] == [False, True]
    for one in found:
        assert one.together < min(15, one.single)
