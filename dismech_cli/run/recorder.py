"""The sink of a run with a directory: frames, events and checkpoints as files."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from ..errors import OutputError
from ..model.saved import Arrays, Numbers
from ..output import checkpoint
from ..output.durable import output_errors
from ..output.events import EventLog
from ..output.frame import Frame, Topology, Writer
from ..output.held import Held
from ..output.jsonable import Json
from ..output.run_directory import CHECKPOINT_FOLDER, EVENTS_FILE
from ..output.writers import WRITERS, make_writer
from .sink import Progress

_FORMAT, _IDENTITY, _NUMBERS = "format", "identity", "numbers"
# Raised whenever a part of a run saves itself under other names.
_VERSION = 7
_PRODUCTS = (EVENTS_FILE, *(name for kind in WRITERS.values() for name in kind.products))


class Recorder:
    """Writes what a run produces into its directory.

    Args:
        run_dir: The run directory; the caller holds its lock.
        writers: Names of the writers.
        identity: What the run is, stored in every checkpoint: see :func:`load_checkpoint`.
    """

    def __init__(self, run_dir: Path, writers: Sequence[str], identity: Mapping[str, Json]) -> None:
        self._run_dir = run_dir
        self._names = tuple(writers)
        self._identity = identity
        self._writers: list[Writer] = []
        self._held = Held()
        self._events: EventLog | None = None

    def open(self, topology: Topology, metadata: Mapping[str, str], resume_at: float | None = None) -> None:
        """Create the files, or cut those that exist to the time of resumption [s].

        Raises:
            OutputError: If a file cannot be opened.
        """
        self._events = EventLog(self._run_dir / EVENTS_FILE, resume_at)
        for name in self._names:
            writer = make_writer(name, self._run_dir, resume_at)
            self._writers.append(writer)
            writer.open(topology, metadata)

    def frame(self, frame: Frame) -> None:
        """Give a frame to every writer, small ones together with others that follow soon.

        Raises:
            OutputError: If one cannot write it, or those before it.
        """
        self._held.add(frame)
        self._write_due()

    def _write_due(self) -> None:
        if self._held.due:
            self._write_all()

    def _write_all(self) -> None:
        if frames := self._held.take():
            for writer in self._writers:
                writer.write(*frames)

    def event(self, kind: str, t: float, **details: object) -> None:
        """Append an event.

        Raises:
            OutputError: If it cannot be written.
        """
        assert self._events is not None
        self._events.add(kind, t, **details)

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Write a checkpoint, after the frames before it.

        Raises:
            OutputError: If it cannot be written; the one before is kept.
        """
        self._write_all()
        meta: dict[str, Json] = {_FORMAT: _VERSION, _IDENTITY: self._identity, _NUMBERS: dict(numbers)}
        checkpoint.save(self._run_dir / CHECKPOINT_FOLDER, arrays, meta)

    def progress(self, progress: Progress) -> None:
        """Write the frames that were held back long enough; they say where the run stands.

        Raises:
            OutputError: If one cannot be written.
        """
        self._write_due()

    def close(self) -> None:
        """Close all files; safe to call twice.

        Raises:
            OutputError: If the last bytes could not be written; the other files are closed all the same.
        """
        with contextlib.ExitStack() as stack:
            for writer in self._writers:
                stack.callback(writer.close)
            if self._events is not None:
                stack.callback(self._events.close)
            self._write_all()
            self._writers = []


class Checkpoint(NamedTuple):
    """What :func:`.loop.run` resumes from."""

    arrays: Arrays
    numbers: Numbers

    @property
    def t(self) -> float:
        """Time [s] of the state."""
        return float(self.numbers["state.t"])


Stored: TypeAlias = tuple[Mapping[str, Json], Checkpoint]
"""The identity given to :class:`Recorder`, and a checkpoint."""


def load_checkpoint(run_dir: Path) -> Stored | None:
    """The newest readable checkpoint of a run, or None if it has not written any.

    Returns:
        The identity given to :class:`Recorder`, and what :func:`.loop.run` resumes from.

    Raises:
        OutputError: If none is readable, or the program version that wrote it saved otherwise.
    """
    return _load(run_dir, lambda arrays, meta: True)


def _load(run_dir: Path, fits: Callable[[Arrays, Mapping[str, Any]], bool]) -> Stored | None:
    folder = run_dir / CHECKPOINT_FOLDER
    if not any(folder.glob("checkpoint-*.npz")):
        return None
    arrays, meta = checkpoint.load_latest(folder, fits)
    if meta.get(_FORMAT) != _VERSION:
        raise OutputError(
            f"the checkpoint in {folder} is of another version of dismech: resume with that one, or run anew"
        )
    return meta[_IDENTITY], Checkpoint(arrays, meta[_NUMBERS])


def load_open_checkpoint(run_dir: Path) -> Stored | None:
    """As :func:`load_checkpoint`, but from before the last step of the run.

    Raises:
        OutputError: likewise.
    """
    return _load(run_dir, lambda arrays, meta: meta.get(_FORMAT) != _VERSION or not _at_end(meta))


def _at_end(meta: Mapping[str, Any]) -> bool:
    return bool(meta[_NUMBERS]["control.done"])


def discard(run_dir: Path) -> None:
    """Remove what a run wrote before its first checkpoint: started anew, it writes the same again.

    Raises:
        OutputError: If a file cannot be removed.
    """
    for name in _PRODUCTS:
        path = run_dir / name
        with output_errors(path, "remove"):
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)
