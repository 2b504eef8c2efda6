"""Packs: files of other programs, of other processes, and of file systems without locks."""

import errno
import fcntl
import os
import tarfile

import pytest

from crackfront.data.packs import Pack, checked, is_locked, members, record


@pytest.mark.parametrize("name", ["über.nc", os.fsdecode(b"\xff.nc"), "日本.nc"])
def test_a_member_of_another_program_may_have_any_name(tmp_path, name):
    path, inner = tmp_path / "flat.0-1.x-1-a.tar", tmp_path / "inner"
    inner.write_bytes(b"content")
    with tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as archive:
        archive.add(inner, name)
    path.write_bytes(record("own.nc", b"own") + path.read_bytes())
    found, _ = members(path)
    assert [one.name for one in found] == ["own.nc", name]
    whole, n_damaged = checked(path)
    assert [one.name for one in whole] == ["own.nc"]
    assert n_damaged >= 1  # no SHA-256


def test_a_member_of_negative_size_ends_no_program(tmp_path):
    head = tarfile.TarInfo("flat.nc")
    head.size = -512
    path = tmp_path / "flat.tar"
    path.write_bytes(head.tobuf(tarfile.GNU_FORMAT) + bytes(512))
    assert members(path) == ([], 1)


@pytest.mark.parametrize("how", ["renamed", "removed", "replaced", "folder"])
def test_a_pack_that_is_taken_away_while_it_is_written_is_begun_anew(tmp_path, how):
    path = tmp_path / "curves/flat.tar"
    pack = Pack(path)
    pack.append({"a": b"1"})
    if how == "removed":
        path.unlink()
    else:
        path.rename(tmp_path / "aside")
    if how == "folder":
        path.parent.rmdir()
    if how == "replaced":
        path.write_bytes(record("kept", b"0"))
    pack.append({"b": b"2"})
    pack.close()
    found, n_damaged = checked(path)
    assert [one.name for one in found] == (["kept", "b"] if how == "replaced" else ["b"])
    assert n_damaged == 0


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_without_locks_a_pack_is_in_use_for_a_minute_after_a_change(tmp_path, monkeypatch, number):
    def without(*arguments):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(fcntl, "flock", without)
    path = tmp_path / "flat.tar"
    pack = Pack(path)
    pack.append({"a": b"1"})
    pack.close()
    assert is_locked(path)
    os.utime(path, (0, path.stat().st_mtime - 100))
    assert not is_locked(path)
