"""A run read back, frame by frame, while it is being written if need be."""

from __future__ import annotations

import itertools
import time
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from ..arrays import FloatArray
from ..errors import OutputError
from .durable import output_errors
from .frame import Topology
from .frame_array import FrameArray
from .hdf5 import vtkhdf
from .hdf5.run_columns import plan_state
from .hdf5.topology import read_topology
from .manifest import Manifest, load_manifest
from .run_directory import RUN_FILE, SCALARS_FILE
from .table import read_table

# A reader may look at the very moment a frame is flushed; the next look finds the file whole.
_ATTEMPTS = 5
_PAUSE = 0.05


class Run:
    """A run directory opened for reading; the files are opened when first asked for.

    Use it as a context manager, or call :meth:`close`. The number of frames is that at opening.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: Any = None
        self._topology: Topology | None = None
        self._frames = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the run file; safe to call twice."""
        if self._file is not None:
            self._file.close()
            self._file = None

    @property
    def manifest(self) -> Manifest:
        """The manifest as it is now.

        Raises:
            OutputError: If it is missing or damaged.
        """
        return load_manifest(self.path)

    @property
    def topology(self) -> Topology:
        """Cells, radii, bodies and the descriptions of fields, state and scalars."""
        self._open()
        assert self._topology is not None
        return self._topology

    @property
    def metadata(self) -> Mapping[str, str]:
        """The metadata given to the writer."""
        return {str(key): str(value) for key, value in self._open()["dismech"].attrs.items()}

    def __len__(self) -> int:
        self._open()
        return self._frames

    @property
    def t(self) -> FloatArray:
        """Times of the frames [s], shape (F,)."""
        return np.asarray(self._open()[vtkhdf.TIMES][: len(self)], dtype=np.float64)

    @property
    def positions(self) -> FrameArray:
        """Node positions [m], frames of shape (N, 3)."""
        file = self._open()
        return FrameArray(file[vtkhdf.POINTS], self._frames, len(self.topology.rest_positions))

    def field(self, name: str) -> FrameArray:
        """A field over all frames, each of shape (count,) or (count, components).

        Raises:
            OutputError: If the run has no such field.
        """
        topology = self.topology
        spec = next((spec for spec in topology.fields if spec.name == name), None)
        if spec is None:
            raise self._unknown("field", name, [spec.name for spec in topology.fields])
        cells = len(topology.edges) + len(topology.triangles)
        rows = len(topology.rest_positions) if spec.location == "node" else cells
        file = self._open()
        return FrameArray(file[vtkhdf.present(file, vtkhdf.field_path(spec))], self._frames, rows)

    def state(self, name: str) -> FrameArray:
        """A raw state array over all frames.

        Raises:
            OutputError: If the run has no such array.
        """
        if name not in self.topology.state:
            raise self._unknown("state array", name, list(self.topology.state))
        return FrameArray(self._open()[f"dismech/state/{name}"], self._frames, None)

    @property
    def scalars(self) -> dict[str, FloatArray]:
        """Columns of ``scalars.csv`` by name, ``t`` included; without that file, those of the frames.

        Raises:
            OutputError: If the table is damaged.
        """
        return self._table()[0]

    @property
    def scalar_units(self) -> dict[str, str]:
        """Units of :attr:`scalars` by name."""
        return self._table()[1]

    def _table(self) -> tuple[dict[str, FloatArray], dict[str, str]]:
        path = self.path / SCALARS_FILE
        if path.exists():
            return read_table(path)
        group = self._open()["dismech/scalars"]
        units = {"t": "s", **self.topology.scalars}
        values = {name: np.asarray(group[name][: self._frames]) for name in self.topology.scalars}
        return {"t": self.t, **values}, units

    def _unknown(self, what: str, name: str, known: list[str]) -> OutputError:
        return OutputError(f"{self.path} has no {what} {name!r}; it has: {', '.join(known) or 'none'}")

    def _open(self) -> Any:
        if self._file is None:
            path = self.path / RUN_FILE
            if not path.is_file():
                raise OutputError(f"cannot read {path}: no such file (was the writer 'hdf5' chosen?)")
            with output_errors(path, "read"):
                self._file, self._topology, self._frames = _open_whole(path)
        return self._file


def _open_whole(path: Path) -> tuple[Any, Topology, int]:
    import h5py

    for attempt in range(_ATTEMPTS):
        file = None
        try:
            file = h5py.File(path, "r", locking=False)
            topology = read_topology(file)
            plans = itertools.chain(vtkhdf.plan_columns(topology), plan_state(topology))
            columns = [column for column, _ in vtkhdf.open_columns(file, plans)]
            return file, topology, vtkhdf.whole_frames(file, columns)
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            if file is not None:
                file.close()
            if attempt == _ATTEMPTS - 1:
                raise OutputError(f"cannot read {path}: it is no run file, or damaged ({error})") from error
            time.sleep(_PAUSE)
    raise AssertionError("unreachable")


def read(run_dir: str | Path) -> Run:
    """Open a run directory for reading.

    Args:
        run_dir: ``results/<name>/<run-id>``.

    Returns:
        The run; nothing is read until it is asked for.

    Raises:
        OutputError: If there is no such directory.
    """
    path = Path(run_dir)
    if not path.is_dir():
        raise OutputError(f"cannot read {path}: no such run directory")
    return Run(path)
