"""The folder for machine code: one that others can write to is not used."""

import os
import stat
from pathlib import Path

import pytest
from gaussmap.runtime.machine_code import disk

pytestmark = pytest.mark.skipif(os.name == "nt", reason="owners and modes are those of POSIX")
ENTRY = ("key", "processor")


@pytest.fixture
def ask(tmp_path, monkeypatch):
    """Return the folder of kernels below a temporary one, asked for anew."""
    monkeypatch.setattr(disk.config, "CACHE_DIR", str(tmp_path / "cache"))

    def ask():
        disk.kept_folder.cache_clear()
        return disk.kept_folder()

    yield ask
    disk.kept_folder.cache_clear()


@pytest.fixture
def loose():
    """Let new files and folders be writable by all."""
    before = os.umask(0)
    yield
    os.umask(before)


def test_folders_are_for_the_user_alone(ask, loose):
    folder = ask()
    disk.save(folder, *ENTRY, b"code")
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert disk.load(folder, *ENTRY) == b"code"
    assert list(disk.entries_in(folder)) == [b"code"]


@pytest.mark.parametrize("mode", [0o770, 0o707])
def test_folders_that_others_can_write_to_are_not_used(mode, ask):
    ask().chmod(mode)
    assert ask() is None


def test_links_are_not_followed(ask, tmp_path):
    folder = ask()
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    assert ask() is None


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives away")
def test_what_belongs_to_others_is_not_used(ask):
    os.chown(ask(), 12345, 12345)
    assert ask() is None


def test_users_without_a_home_have_kernels(ask, monkeypatch):
    def without() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", without)
    monkeypatch.setattr(disk.config, "CACHE_DIR", "")
    assert ask() is not None
