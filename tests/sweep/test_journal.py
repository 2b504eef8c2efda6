"""Journals: whole lines count, torn and changed ones do not, and two writers do not meet."""

from dataclasses import replace
from pathlib import Path

import pytest

from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.journal import Entry, Journal, journal_paths, read_journal
from crackfront.sweep.table import failed_row

SWEEP = load_configuration(Path(__file__).parents[2] / "config/test.yaml")
ONE = SWEEP.shard(SWEEP.spectra[0])[0]
BEGUN = Entry(ONE.key, ONE.label, ONE.parts)
ENDED = replace(BEGUN, definition="now", row=failed_row(ONE, "refused", "too rough: 1 > 0.999"))


def entries(folder, definition="now"):
    """Entries of all journals of a folder."""
    paths = journal_paths(folder)
    return [entry for path in paths for _, entry in read_journal(path, definition)]


def same(one, other):
    """Whether two entries are equal, NaN included."""
    return repr(one) == repr(other)


def test_what_is_appended_is_read_back_in_order_and_to_the_last_bit(tmp_path):
    journal = Journal(tmp_path)
    third = replace(ENDED, row=replace(ENDED.row, w_appr=0.1 + 0.2))
    for entry in (BEGUN, ENDED, third):
        journal.append(entry)
    assert same(entries(tmp_path), [BEGUN, ENDED, third])


@pytest.mark.parametrize("left", [1, 20, 200, -1])
def test_a_torn_last_line_does_not_count_and_the_others_do(tmp_path, left):
    journal = Journal(tmp_path)
    journal.append(BEGUN)
    [path] = journal_paths(tmp_path)
    whole = path.stat().st_size
    journal.append(ENDED)
    content = path.read_bytes()
    path.write_bytes(content[:left] if left < 0 else content[: whole + left])
    assert same(entries(tmp_path), [BEGUN])


def test_a_line_with_a_flipped_bit_does_not_count_and_the_others_do(tmp_path):
    journal = Journal(tmp_path)
    for entry in (BEGUN, ENDED, BEGUN):
        journal.append(entry)
    [path] = journal_paths(tmp_path)
    content = bytearray(path.read_bytes())
    content[content.index(b"refused")] ^= 1
    path.write_bytes(content)
    assert same(entries(tmp_path), [BEGUN, BEGUN])


def test_zeros_that_a_crash_leaves_do_not_count(tmp_path):
    journal = Journal(tmp_path)
    journal.append(BEGUN)
    [path] = journal_paths(tmp_path)
    with path.open("ab") as file:
        file.write(bytes(4096))
    assert same(entries(tmp_path), [BEGUN])


def test_two_writers_have_two_files(tmp_path):
    first, second = Journal(tmp_path), Journal(tmp_path)
    first.append(BEGUN)
    second.append(ENDED)
    assert len(journal_paths(tmp_path)) == 2
    assert len(entries(tmp_path)) == 2


def test_a_row_of_another_definition_comes_without_it(tmp_path):
    Journal(tmp_path).append(ENDED)
    [entry] = entries(tmp_path, "later")
    assert entry.row is None
    assert entry.key == ONE.key


def test_a_line_that_the_disk_does_not_take_leaves_nothing(tmp_path, monkeypatch):
    journal = Journal(tmp_path)
    journal.append(BEGUN)
    [path] = journal_paths(tmp_path)
    before = path.read_bytes()

    def full(_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("crackfront.sweep.journal.os.fsync", full)
        with pytest.raises(OSError, match="No space left"):
            journal.append(ENDED)
    assert path.read_bytes() == before
    journal.append(ENDED)
    assert same(entries(tmp_path), [BEGUN, ENDED])
