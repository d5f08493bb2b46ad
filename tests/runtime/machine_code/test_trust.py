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


def link(file):
    """Put a link in place of a file."""
    elsewhere = file.parents[1] / "elsewhere"
    file.rename(elsewhere)
    file.symlink_to(elsewhere)


def give_away(path):
    if os.geteuid() != 0:
        pytest.skip("only root gives away")
    os.chown(path, 12345, 12345)


@pytest.mark.parametrize("spoil", [lambda x: x.chmod(0o770), lambda x: x.chmod(0o707), give_away])
def test_folders_that_others_can_write_to_are_not_used(spoil, ask):
    spoil(ask())
    with pytest.warns(gm.GaussmapWarning, match="in each process: others than you may write"):
        assert ask() is None


@pytest.mark.parametrize(
    "spoil", [lambda x: x.chmod(0o620), lambda x: x.chmod(0o602), link, give_away]
)
def test_files_that_others_can_write_to_are_not_read(spoil, ask):
    folder = ask()
    disk.save(folder, *ENTRY, b"code")
    (file,) = folder.iterdir()
    spoil(file)
    assert disk.load(folder, *ENTRY) is None
    assert file.is_symlink() or list(disk.entries_in(folder)) == []


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
