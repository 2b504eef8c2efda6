"""What the shipped table of the front's hysteresis against boundary elements is told to say."""

from crackfront.analysis.validity import (
    ValidityRow,
    largest_energy,
    validity_of,
    validity_sentence,
    validity_text,
)


def test_the_range_ends_below_the_first_amplitude_that_is_outside_for_any_spectrum():
    def row(energy, ratio, hurst=1.0):
        return ValidityRow(1.0, hurst, energy, ratio, 0.02, 4, 4, 256, 0.2)

    rows = [row(0.03, 1.02), row(0.06, 0.85), row(0.1, 1.02), row(0.03, 1.24, 0.8)]
    assert largest_energy(rows, 0.25) == 0.1
    assert largest_energy(rows, 0.1) == 0
    assert largest_energy(rows[:3], 0.1) == 0.03
    assert largest_energy([row(0.03, 1.115)], 0.1) == 0.03  # within its error of 0.02
    assert largest_energy([row(0.03, 1.13)], 0.1) == 0
    assert (
        "to 10% nowhere from e_el/w_int = 0.03 on, and to 25% up to e_el/w_int = 0.1, the "
        "strongest that was compared; at worst it is 1.2 ± 0.0 times theirs, at e_el/w_int = 0.03."
    ) in validity_sentence(rows)
    assert "to 25%" not in validity_sentence(rows[:1])
    assert validity_of(validity_text(rows)) == tuple(rows)
