"""Compiled kernels are executed, so they lie where nobody else can leave any."""

from __future__ import annotations

import functools
import os
import warnings
from pathlib import Path

import pytest

from dismech_cli.kernels import cache

pytest.importorskip("numba")
posix = pytest.mark.skipif(not hasattr(os, "getuid"), reason="Windows closes folders by access lists")


@pytest.fixture(autouse=True)
def new_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a process remembers of its folders is forgotten for a test."""
    for name in ("_trusted", "temporary_folder"):
        monkeypatch.setattr(cache, name, functools.cache(getattr(cache, name).__wrapped__))


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the cache is asked to be."""
    monkeypatch.setenv("DISMECH_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def refused(reason: str) -> Path:
    """The folder taken instead, after one word of the reason."""
    with pytest.warns(UserWarning, match=reason):
        folder = cache.cache_folder()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cache.cache_folder() == folder, "said once"
    assert folder.is_dir()
    if hasattr(os, "getuid"):
        assert folder.stat().st_mode & 0o777 == 0o700
    return folder


def test_folder_is_made_for_its_owner(place: Path) -> None:
    folder = cache.cache_folder()
    assert folder.is_relative_to(place)
    if hasattr(os, "getuid"):
        assert all(path.stat().st_mode & 0o777 == 0o700 for path in (folder, *folder.parents[:2]))


def test_cache_of_the_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISMECH_CACHE", raising=False)
    monkeypatch.setattr(cache, "user_cache_path", lambda *_, **__: tmp_path / "Caches" / "dismech")
    assert cache.cache_folder().is_relative_to(tmp_path / "Caches" / "dismech")


@posix
def test_hostile_folder_is_not_taken_over(place: Path) -> None:
    """Made beforehand and open to others, who may have left code in it."""
    folder = cache.cache_folder()
    folder.chmod(0o777)
    cache._trusted.cache_clear()
    assert not refused("others can write to").is_relative_to(place)


@posix
@pytest.mark.parametrize("depth", [0, 1, 2])
def test_links_are_not_followed(place: Path, tmp_path: Path, depth: int) -> None:
    folder = cache.cache_folder()
    part = (folder, *folder.parents)[depth]
    elsewhere = tmp_path / "elsewhere"
    part.rename(elsewhere)
    part.symlink_to(elsewhere)
    cache._trusted.cache_clear()
    assert not refused("is a link").is_relative_to(tmp_path)


@posix
def test_folder_of_another_user(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    someone = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: someone)
    assert not refused("belongs to another user").is_relative_to(place)


@posix
def test_world_writable_place(place: Path) -> None:
    """Whoever can rename the folder can put another in its place; the sticky bit of /tmp forbids it."""
    place.mkdir()
    place.chmod(0o777)
    assert not refused("everybody can write to").is_relative_to(place)
    place.chmod(0o1777)
    cache._trusted.cache_clear()
    assert cache.cache_folder().is_relative_to(place)


@posix
def test_folders_above_are_closed(place: Path) -> None:
    """A loose umask leaves them open to a group; what lies in them is looked at after that."""
    (place / "dismech").mkdir(parents=True)
    (place / "dismech").chmod(0o775)
    folder = cache.cache_folder()
    assert folder.is_relative_to(place)
    assert (place / "dismech").stat().st_mode & 0o777 == 0o755


def test_place_that_cannot_be_made(place: Path) -> None:
    place.write_text("a file")
    assert not refused("cannot be made").is_relative_to(place)


def test_read_only_home(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache.cache_folder()
    cache._trusted.cache_clear()
    monkeypatch.setattr(os, "access", lambda path, mode: not mode & os.W_OK)
    assert not refused("cannot be written to").is_relative_to(place)


def test_without_user_numbers(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on Windows."""
    monkeypatch.delattr(os, "getuid", raising=False)
    assert cache.cache_folder().is_relative_to(place)
    cache._trusted.cache_clear()
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    refused("cannot be written to")
