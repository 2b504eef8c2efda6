"""Pages that studies write into."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from studies.__main__ import main
from studies.pages import Part, keep_parts, kept_parts, renewed, stale

ROOT = Path(__file__).parents[2]
PAGE = "<!-- law: limit -->\nold\n<!-- end -->\nAfter <!-- speed: limit -->7<!-- end --> times\n"


def part(text):
    return Part(text, "studies law", "1a2b3c4d5e", "EPYC", ["studies.pages"], "")


def test_blocks_are_written_with_their_origin_and_numbers_within_a_line_alone():
    parts = {"law": {"limit": part("| 3 |")}, "speed": {"limit": part("8")}}
    text = renewed(PAGE, parts)
    assert "-->\n\n| 3 |\n\n*Commit 1a2b3c4, EPYC: `studies law`*\n\n<!--" in text
    assert "After <!-- speed: limit -->8<!-- end --> times" in text
    assert renewed(text, parts) == text
    table = {"law": {"limit": part("| a | b |\n| --- | --- |\n| 1 | 2 |\n| 1 | 3 |")}}
    cell = "k is <!-- law: limit / 1 | 3 / 2 -->0<!-- end -->"
    assert renewed(cell, table) == cell.replace(">0<", ">3<")
    with pytest.raises(ValueError, match="no row of the table begins with '4'"):
        renewed(cell.replace("1 | 3", "4"), table)
    with pytest.raises(ValueError, match="'limit' of the study speed, which has not measured it"):
        renewed(PAGE, {"law": parts["law"]})


def test_parts_of_other_sources_are_told_until_they_are_measured_anew(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    keep_parts("law", {"limit": "3"}, "studies.pages", data={"command": "a", "git_commit": "b"})
    assert [*stale(kept_parts())] == ["of other sources than today's, commit b, `a`: law: limit"]
    keep_parts("law", {"limit": "4", "more": "5"}, "studies.pages")
    assert [*stale(kept_parts())] == []
    assert kept_parts()["law"]["limit"].text == "4"


def test_the_pages_hold_what_was_kept(monkeypatch):
    monkeypatch.chdir(ROOT)
    done = CliRunner().invoke(main, ["pages", "--check"])
    assert done.exit_code == 0, done.output  # Otherwise: python -m studies pages
    known = {(study, name) for study, parts in kept_parts().items() for name in parts}
    pages = [Path("README.md"), *Path("docs").rglob("*.md")]
    blocks = {
        block
        for page in pages
        for block in re.findall(r"<!-- ([\w-]+): (.*?) -->", page.read_text())
    }
    begun = [
        page for page in pages if re.search(r"^<!-- .*<!-- end", page.read_text(), re.MULTILINE)
    ]
    assert begun == []  # Markdown would end the paragraph there.
    assert {(study, name.split(" / ")[0]) for study, name in blocks} == known
