"""The run file: one HDF5 file that ParaView opens directly and that holds the exact state."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import OutputError
from ..durable import output_errors
from ..frame import Frame, Topology
from . import disk_space, vtkhdf
from .column import Column
from .run_columns import plan_state
from .topology import read_topology, write_topology
from .vtkhdf import ColumnPlan, Value


class Hdf5Writer:
    """Appends frames to one file, flushed to the system after each call.

    The file has the group ``VTKHDF`` (positions and fields, for ParaView) beside ``dismech/state``,
    ``dismech/scalars``, ``dismech/topology`` and the attributes of ``dismech`` (the metadata).

    Args:
        path: The file, usually ``run.vtkhdf``.
        resume_at: Continue a file that exists, keeping its frames with t <= ``resume_at`` [s];
            None makes a new file.
    """

    def __init__(self, path: Path, resume_at: float | None = None) -> None:
        self._path = path
        self._resume_at = resume_at
        self._file: Any = None
        self._columns: list[tuple[Column, Value]] = []
        self._frames = 0

    def open(self, topology: Topology, metadata: Mapping[str, str]) -> None:
        """Create the file, or reopen and cut it.

        Raises:
            OutputError: If the file exists (new run), is missing, damaged or of another model (resume).
        """
        if self._resume_at is None:
            self._create(topology, metadata)
        else:
            self._reopen(topology, self._resume_at)

    def _create(self, topology: Topology, metadata: Mapping[str, str]) -> None:
        with output_errors(self._path, "create"):
            self._file = _open_file(self._path, "x")
            vtkhdf.write_static(self._file, topology)
            write_topology(self._file, topology)
            self._file["dismech"].attrs.update(metadata)
            for group in ("dismech/state", "dismech/scalars"):
                self._file.require_group(group)
            self._columns = vtkhdf.create_columns(self._file, _plan(topology))
            self._file.flush()

    def _reopen(self, topology: Topology, resume_at: float) -> None:
        with output_errors(self._path, "resume"):
            self._file = _open_file(self._path, "r+")
            try:
                self._columns = vtkhdf.open_columns(self._file, _plan(topology))
                stored = read_topology(self._file)
            except (KeyError, ValueError) as error:
                raise OutputError(f"cannot resume {self._path}: it holds another model ({error})") from error
            if not _same_model(stored, topology):
                raise OutputError(
                    f"cannot resume {self._path}: it holds another model (nodes or cells differ)"
                )
            whole = vtkhdf.whole_frames(self._file, [column for column, _ in self._columns])
            times = self._file[vtkhdf.TIMES][:whole]
            self._frames = int(np.count_nonzero(times <= resume_at))
            vtkhdf.set_step_count(self._file, self._frames)
            self._file.flush()
            for column, _ in self._columns:
                column.truncate(self._frames)
            self._file.flush()

    def write(self, *frames: Frame) -> None:
        """Append frames; after return they survive the death of this process.

        Raises:
            OutputError: If there is no room or the write fails; frames that had room are kept.
        """
        with output_errors(self._path):
            try:
                self._reserve(len(frames))
            except OSError:
                # no room for all: as many as there is room for
                for frame in frames:
                    self._reserve(1)
                    self._put((frame,))
            else:
                self._put(frames)

    def _reserve(self, frames: int) -> None:
        room = disk_space.room_for([column.room(frames) for column, _ in self._columns])
        disk_space.reserve(self._file, room)

    def _put(self, frames: Sequence[Frame]) -> None:
        first = self._frames
        for column, value in self._columns:
            column.put(first, [value(frame, row) for row, frame in enumerate(frames, first)])
        # Frames count once they are whole in the file: their data first, then the number of steps.
        self._file.flush()
        vtkhdf.set_step_count(self._file, first + len(frames))
        self._file.flush()
        self._frames += len(frames)

    def close(self) -> None:
        """Close the file; safe to call twice.

        Raises:
            OutputError: If the last bytes could not be written.
        """
        if self._file is None:
            return
        file, self._file = self._file, None
        self._columns = []
        with output_errors(self._path, "close"):
            file.flush()
            disk_space.release(file)
            file.close()


def _open_file(path: Path, mode: str) -> Any:
    import h5py

    # The default file format survives kill -9; the lock would keep ParaView out of a running file.
    return h5py.File(path, mode, locking=False)


def _plan(topology: Topology) -> Iterator[ColumnPlan]:
    return itertools.chain(vtkhdf.plan_columns(topology), plan_state(topology))


def _same_model(stored: Topology, topology: Topology) -> bool:
    return all(
        np.array_equal(getattr(stored, name), getattr(topology, name))
        for name in ("rest_positions", "edges", "triangles")
    )
