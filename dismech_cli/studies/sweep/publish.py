"""Points that are worked at and points that are done: a folder appears whole under its name, or not at all.

Who works at a point does so in a hidden folder beside the others, which tells who that is. A rename onto a
folder that holds something fails: of two who finish the same point, the first wins and the second throws
its work away.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import sys
import time
import uuid
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

from ...frozen import frozen
from ...output.durable import output_errors, sync_folder, write_bytes

RESULT_FILE = "result.json"
_OWNER_FILE = "owner.json"
_HIDDEN = re.compile(r"\.(?P<id>[0-9a-f]{16})\.[0-9a-f]{32}")
# What another machine works at cannot be looked at; after so long nobody does [s].
_GIVEN_UP = 7 * 86400.0


@frozen
class Owner:
    """A process, told from later ones with its number by when it started.

    Attributes:
        pid: Its number.
        host: Its machine.
        started: When it started, as that system counts; empty where it does not tell.
    """

    pid: int
    host: str
    started: str

    @classmethod
    def this(cls) -> Owner:
        """The process that asks."""
        return cls(os.getpid(), socket.gethostname(), _started(os.getpid()))

    @property
    def is_here(self) -> bool:
        """Whether it is, or was, on this machine."""
        return self.host == socket.gethostname()

    @property
    def is_dead(self) -> bool:
        """Whether it is known to have ended."""
        # Windows would take the question for Ctrl-C
        if not self.is_here or sys.platform == "win32":
            return False
        try:
            os.kill(self.pid, 0)
        except ProcessLookupError:
            return True
        except OSError:
            pass
        return _started(self.pid) != self.started or _is_zombie(self.pid)


@frozen
class Work:
    """A point being worked at.

    Attributes:
        hidden: The hidden folder.
        id: Name of the point.
    """

    hidden: Path
    id: str

    @property
    def folder(self) -> Path:
        """What will be published."""
        return self.hidden / self.id

    @property
    def owner(self) -> Owner | None:
        """Who works at it; None where that cannot be read."""
        try:
            return Owner(**json.loads((self.hidden / _OWNER_FILE).read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None


def begin(points: Path, id: str) -> Work:
    """Make the hidden folder of a point.

    Raises:
        OutputError: If it cannot be made.
    """
    work = Work(points / f".{id}.{uuid.uuid4().hex}", id)
    with output_errors(work.hidden, "create"):
        work.hidden.mkdir()
    write_bytes(work.hidden / _OWNER_FILE, json.dumps(asdict(Owner.this())).encode())
    return work


def publish(work: Work) -> bool:
    """Give a finished point its name; it is on the disk before it has it.

    Returns:
        Whether it was the first; if not, the work is thrown away.

    Raises:
        OutputError: If it cannot be written.
    """
    points = work.hidden.parent
    with output_errors(work.folder):
        _sync(work.folder)
    with output_errors(points / work.id):
        try:
            work.folder.rename(points / work.id)
            first = True
        except OSError:
            if not is_done(points, work.id):
                raise
            first = False
    sync_folder(points)
    discard(work)
    return first


def discard(work: Work) -> None:
    """Throw a hidden folder away."""
    shutil.rmtree(work.hidden, ignore_errors=True)


def withdraw(points: Path, id: str) -> None:
    """Take the result of a point away, so that it is made again: hidden first, so that it goes at once."""
    grave = Work(points / f".{id}.{uuid.uuid4().hex}", id)
    with output_errors(points / id, "remove"), suppress(FileNotFoundError):
        (points / id).rename(grave.hidden)
    discard(grave)


def is_done(points: Path, id: str) -> bool:
    """Whether a point has a result."""
    return (points / id / RESULT_FILE).is_file()


def in_work(points: Path) -> Iterator[Work]:
    """Every hidden folder."""
    with suppress(FileNotFoundError):
        for entry in sorted(points.iterdir()):
            if found := _HIDDEN.fullmatch(entry.name):
                yield Work(entry, found["id"])


def remove_dead(points: Path) -> int:
    """Remove what dead processes of this machine left; that of other machines once it is a week old.

    Returns:
        How many folders.
    """
    removed = 0
    for work in in_work(points):
        owner = work.owner
        if (owner is not None and owner.is_dead) or _is_old(work, owner):
            discard(work)
            removed += 1
    return removed


def others_at(points: Path, mine: frozenset[str]) -> frozenset[str]:
    """Points that somebody alive on this machine works at, those in ``mine`` left out."""
    return frozenset(
        work.id
        for work in in_work(points)
        if work.id not in mine and (owner := work.owner) is not None and owner.is_here and not owner.is_dead
    )


def _is_old(work: Work, owner: Owner | None) -> bool:
    """Whether a folder that tells no owner, or one elsewhere, has not been touched for long."""
    if owner is not None and owner.is_here:
        return False
    try:
        age = time.time() - max(entry.stat().st_mtime for entry in (work.hidden, *work.hidden.rglob("*")))
    except OSError:
        return False
    return age > (_GIVEN_UP if owner is not None else 60.0)


def _sync(folder: Path) -> None:
    for entry in folder.iterdir():
        if entry.is_dir():
            _sync(entry)
        elif entry.is_file():
            descriptor = os.open(entry, os.O_RDONLY)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)
    sync_folder(folder)


def _stat(pid: int) -> list[str]:
    """The fields of ``/proc/PID/stat`` after the name, which may hold blanks; none on other systems."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return []


def _started(pid: int) -> str:
    fields = _stat(pid)
    return fields[19] if len(fields) > 19 else ""


def _is_zombie(pid: int) -> bool:
    return _stat(pid)[:1] == ["Z"]
