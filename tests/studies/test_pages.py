"""Pages that studies write into."""

import pytest

from studies.pages import described_machine, renewed

PAGE = "Before\n<!-- law: limit -->\nold\n<!-- end -->\nAfter <!-- speed: limit --><!-- end -->\n"


def test_a_page_keeps_its_words_and_the_blocks_of_other_studies():
    text = renewed(PAGE, "law", {"limit": "| 3 |", "more": "| 4 |"})
    assert text == PAGE.replace("\nold\n", "\n\n| 3 |\n\n")
    assert renewed(text, "law", {"limit": "| 3 |"}) == text


def test_a_block_that_was_not_measured_is_refused():
    with pytest.raises(ValueError, match="'limit', which the study law has not measured; there"):
        renewed(PAGE, "law", {"weather": ""})


def test_the_machine_is_named_with_the_commit():
    assert "cores, Python 3." in described_machine()
    assert "commit " in described_machine()
