"""e_el of synthetic scans: what predictions from large maps take."""

import pytest

from studies.accuracy.predicted_energies import speeds


@pytest.mark.slow
def test_ten_large_maps_take_less_than_15_s_of_one_core():
    found = list(speeds())
    assert [one.what for one in found] == ["without figure", "with figure"]
    for one in found:
        assert one.together < min(15, one.single)
