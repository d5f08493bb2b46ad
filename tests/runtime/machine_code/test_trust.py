"""Machine code that others can write is not run."""

import os
import stat
from pathlib import Path

import gaussmap as gm
import pytest
from gaussmap.runtime.machine_code import disk, shipped
from gaussmap.runtime.machine_code.trust import is_as_safe_as_sources

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


def test_folders_and_files_are_for_the_user_alone(ask, loose):
    folder = ask()
    disk.save(folder, *ENTRY, b"code")
    (file,) = folder.iterdir()
    assert [stat.S_IMODE(x.stat().st_mode) for x in (folder, file)] == [0o700, 0o600]
    assert disk.load(folder, *ENTRY) == b"code"
    assert list(disk.entries_in(folder)) == [b"code"]


@pytest.mark.parametrize("mode", [0o770, 0o707])
def test_folders_that_others_can_write_to_are_not_used(mode, ask):
    folder = ask()
    folder.chmod(mode)
    with pytest.warns(gm.GaussmapWarning, match="kernels are compiled in each process"):
        assert ask() is None


@pytest.mark.parametrize("mode", [0o620, 0o602])
def test_files_that_others_can_write_to_are_not_read(mode, ask):
    folder = ask()
    disk.save(folder, *ENTRY, b"code")
    (file,) = folder.iterdir()
    file.chmod(mode)
    assert disk.load(folder, *ENTRY) is None
    assert list(disk.entries_in(folder)) == []


def test_links_are_not_followed(ask, tmp_path):
    folder = ask()
    disk.save(folder, *ENTRY, b"code")
    (file,) = folder.iterdir()
    file.rename(tmp_path / "elsewhere")
    file.symlink_to(tmp_path / "elsewhere")
    assert disk.load(folder, *ENTRY) is None


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives away")
def test_what_belongs_to_others_is_not_used(ask):
    folder = ask()
    disk.save(folder, *ENTRY, b"code")
    (file,) = folder.iterdir()
    os.chown(file, 12345, 12345)
    assert disk.load(folder, *ENTRY) is None
    os.chown(folder, 12345, 12345)
    with pytest.warns(gm.GaussmapWarning, match="others than you may write"):
        assert ask() is None


def test_what_a_wheel_ships_is_as_safe_as_its_sources(tmp_path, monkeypatch):
    path = tmp_path / "x.kernels"
    shipped.write_pack(path, {})
    monkeypatch.setattr(shipped, "pack_path", lambda: path)
    monkeypatch.setattr(shipped.config, "DISABLE_JIT", 0)
    monkeypatch.delenv(shipped.SWITCH, raising=False)
    assert is_as_safe_as_sources(path)
    path.chmod(0o666)
    assert not is_as_safe_as_sources(path)
    shipped.open_pack.cache_clear()
    assert shipped.open_pack() is None
    shipped.open_pack.cache_clear()


def test_users_without_a_home_have_kernels(ask, monkeypatch):
    def without() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", without)
    monkeypatch.setattr(disk.config, "CACHE_DIR", "")
    assert ask() is not None
