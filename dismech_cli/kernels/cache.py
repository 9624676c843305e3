"""The folder of compiled kernels: the user's own, since what lies there is executed.

Whoever can write to the folder could leave code in it that the next run would load, so it must belong to
this user and be closed to everybody else; where it is not, a fresh one serves for as long as this
process lives.
"""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import sys
import tempfile
import warnings
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

from .availability import numba_version


def cache_folder() -> Path:
    """Folder of loops and compiled code for this Python and this Numba; exists.

    It lies in the user's cache directory, or in that of ``DISMECH_CACHE``.

    Raises:
        OSError: Neither it nor a temporary folder can be made.

    Warns:
        UserWarning: The folder cannot be made or cannot be trusted: said once, with the reason.
    """
    chosen = os.environ.get("DISMECH_CACHE")
    base = Path(chosen) / "dismech" if chosen else user_cache_path("dismech", appauthor=False)
    return _trusted(base.absolute() / "kernels" / f"numba-{numba_version()}-{sys.implementation.cache_tag}")


@cache
def temporary_folder() -> Path:
    """A fresh folder of this process alone, removed when it ends."""
    folder = tempfile.mkdtemp(prefix="dismech-kernels-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


@cache
def _trusted(folder: Path) -> Path:
    try:
        doubt = _doubt(folder)
    except OSError as error:
        doubt = f"{folder} cannot be made ({error.strerror})"
    if not doubt:
        return folder
    warnings.warn(
        f"compiled kernels are not kept after this run: {doubt}; DISMECH_CACHE may name another folder",
        stacklevel=3,
    )
    return temporary_folder()


def _doubt(folder: Path) -> str:
    """Make a folder that only this user can write to; what speaks against trusting it, or nothing."""
    top, middle = folder.parents[1], folder.parents[0]
    top.parent.mkdir(parents=True, exist_ok=True)
    doubt = _doubt_of_place(top.parent.resolve())
    for part in (top, middle, folder):
        if not doubt:
            part.mkdir(mode=0o700, exist_ok=True)
            doubt = _doubt_of_owner(part)
    if doubt:
        return doubt
    for part in (top, middle):
        _close(part)
    # last, when nobody else can exchange it any more
    if _is_open(folder):
        return f"others can write to {folder}"
    return "" if os.access(folder, os.W_OK | os.X_OK) else f"{folder} cannot be written to"


def _doubt_of_place(place: Path) -> str:
    for above in (place, *place.parents) if _has_owners() else ():
        mode = above.stat().st_mode
        # others cannot rename what is not theirs where the sticky bit is set, as in /tmp
        if mode & stat.S_IWOTH and not mode & stat.S_ISVTX:
            return f"everybody can write to {above}"
    return ""


def _doubt_of_owner(part: Path) -> str:
    facts = part.lstat()
    if not stat.S_ISDIR(facts.st_mode):
        return f"{part} is a link"
    if _has_owners() and facts.st_uid != os.getuid():
        return f"{part} belongs to another user"
    return ""


def _has_owners() -> bool:
    """Whether folders have owners and modes; Windows closes those of a user by their access lists."""
    return hasattr(os, "getuid")


def _is_open(part: Path) -> bool:
    return _has_owners() and bool(part.lstat().st_mode & (stat.S_IWGRP | stat.S_IWOTH))


def _close(part: Path) -> None:
    """Take away what a loose umask gave to others."""
    if _is_open(part):
        part.chmod(part.lstat().st_mode & 0o755)
