"""Claims: what one process simulates another one waits for, and nothing else waits."""

import errno
import fcntl
import subprocess
import sys
import threading

import pytest

from crackfront.sweep import claims
from crackfront.sweep.claims import claimed
from crackfront.sweep.sweep import NamedSpectrum, Shard

HOLD = """
import fcntl, sys
with open(sys.argv[1], "ab") as file:
    fcntl.lockf(file, fcntl.LOCK_EX, int(sys.argv[3]), int(sys.argv[2]))
    print("held", flush=True)
    sys.stdin.read()
"""


def shard(first, stop, name="flat"):
    """A shard of some realisations."""
    return Shard(NamedSpectrum(name, None), range(first, stop), name)


@pytest.fixture
def other(tmp_path):
    """Another process that simulates realisations 4 to 7."""
    told = [sys.executable, "-c", HOLD, str(tmp_path / ".flat.lock"), "4", "4"]
    with subprocess.Popen(told, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"held\n"
        yield process
        process.kill()


@pytest.mark.parametrize("block", [(4, 8), (0, 5), (7, 9), (5, 6)])
def test_a_process_waits_for_another_one_at_the_same_realisations(
    tmp_path, monkeypatch, other, block
):
    monkeypatch.setattr(claims, "_SECONDS", 0.02)
    said, ended = [], []

    def end():
        ended.append(other.pid)
        other.kill()

    def announce(sentence):
        said.append(sentence)
        threading.Timer(0.1, end).start()

    with claimed(tmp_path, [shard(0, 4, "rough"), shard(*block)], announce) as waited:
        assert waited
        assert ended
    [sentence] = said
    named = f"realisations {block[0]} to {block[1] - 1} of flat in {tmp_path} already; waiting"
    assert named in sentence


@pytest.mark.parametrize(("block", "name"), [((0, 4), "flat"), ((8, 9), "flat"), ((0, 9), "rough")])
@pytest.mark.usefixtures("other")
def test_a_process_at_other_realisations_or_spectra_waits_for_nothing(tmp_path, block, name):
    said = []
    with claimed(tmp_path, [shard(*block, name)], said.append) as waited:
        assert not waited
    assert said == []


def test_a_file_of_another_user_holds_nothing(tmp_path, monkeypatch):
    def refused(path, mode):
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(type(tmp_path), "open", refused)
    with claimed(tmp_path, [shard(0, 4)], print) as waited:
        assert not waited


def test_a_file_system_without_locks_holds_nothing(tmp_path, monkeypatch):
    def without(*arguments):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "lockf", without)
    with claimed(tmp_path, [shard(0, 4)], print) as waited:
        assert not waited


@pytest.mark.usefixtures("other")
def test_a_process_that_is_to_stop_waits_no_longer(tmp_path, monkeypatch):
    monkeypatch.setattr(claims, "stop_is_requested", lambda: True)
    with pytest.raises(KeyboardInterrupt), claimed(tmp_path, [shard(4, 5)], list):
        pass
