"""Fixtures of the tests of the core."""

import tempfile

import pytest

from crackfront.core import cache_folder


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch):
    """Folder of caches that is empty yet; temporary files are next to it."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(cache_folder.numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    cache_folder.kernel_folder.cache_clear()
    yield tmp_path / "cache/crackfront"
    cache_folder.kernel_folder.cache_clear()
