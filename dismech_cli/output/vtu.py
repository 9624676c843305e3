"""One VTU file per frame and a PVD file that lists them with their times."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from ..errors import OutputError
from .durable import output_errors, staged, write_bytes, write_fully
from .frame import FieldSpec, Frame, Topology
from .viewer import DISPLACEMENT, array_name, mesh_arrays

SERIES_FILE = "series.pvd"
FRAMES_FOLDER = "frames"

_HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
_TAIL = "</Collection>\n</VTKFile>\n"
_ENTRY = re.compile(r'<DataSet timestep="([^"]+)" part="0" file="([^"]+)"/>\n')


class VtuWriter:
    """Writes ``frames/NNNNNN.vtu`` and ``series.pvd`` inside a folder.

    Args:
        folder: The run directory.
        resume_at: Keep the frames with t <= ``resume_at`` [s] and continue; None starts anew.
    """

    def __init__(self, folder: Path, resume_at: float | None = None) -> None:
        self._frames = folder / FRAMES_FOLDER
        self._series = folder / SERIES_FILE
        self._resume_at = resume_at
        self._end = len(_HEAD)
        self._topology: Topology | None = None

    def open(self, topology: Topology, metadata: Mapping[str, str]) -> None:
        """Make the folder and the series file, or cut a series that exists.

        Raises:
            OutputError: If a series exists (new run), is missing (resume) or cannot be written.
        """
        self._topology = topology
        entries = "" if self._resume_at is None else self._kept(self._resume_at)
        if self._resume_at is None and self._series.exists():
            raise OutputError(f"cannot create {self._series}: it exists already and is never overwritten")
        with output_errors(self._frames, "create"):
            self._frames.mkdir(parents=True, exist_ok=True)
        write_bytes(self._series, (_HEAD + entries + _TAIL).encode())
        self._end = len((_HEAD + entries).encode())

    def _kept(self, resume_at: float) -> str:
        """Entries of the series up to the time of resumption; later frame files are removed."""
        with output_errors(self._series, "resume"):
            text = self._series.read_text(encoding="utf-8")
            kept = []
            for entry in _ENTRY.finditer(text):
                if float(entry[1]) <= resume_at:
                    kept.append(entry[0])
                else:
                    (self._series.parent / entry[2]).unlink(missing_ok=True)
        return "".join(kept)

    def write(self, *frames: Frame) -> None:
        """Write frames, each before it is entered in the series.

        Raises:
            OutputError: If either file cannot be written; earlier frames are kept.
        """
        if self._topology is None:
            raise ValueError("write before open")
        for frame in frames:
            self._append(self._topology, frame)

    def _append(self, topology: Topology, frame: Frame) -> None:
        path = self._frames / f"{frame.index:06d}.vtu"
        with staged(path) as temporary:
            write_vtu(temporary, topology, frame)
        entry = f'<DataSet timestep="{frame.t!r}" part="0" file="{FRAMES_FOLDER}/{path.name}"/>\n'.encode()
        with output_errors(self._series), self._series.open("r+b", buffering=0) as file:
            _replace_end(file, self._end, entry)
        self._end += len(entry)

    def close(self) -> None:
        """Do nothing: every frame is complete when it is written."""


def _replace_end(file: IO[bytes], end: int, entry: bytes) -> None:
    """Put ``entry`` before the closing tags, which start at byte ``end``.

    One write replaces the closing tags by the entry and the closing tags: the file is valid XML before
    and after, and a run of n frames costs n short writes, not n rewrites of the whole list.
    """
    tail = _TAIL.encode()
    try:
        file.seek(end)
        write_fully(file, entry + tail)
    except OSError:
        # These bytes are on the disk already: restoring them needs no room.
        file.seek(end)
        file.write(tail)
        file.truncate()
        raise


def write_vtu(path: Path, topology: Topology, frame: Frame) -> None:
    """Write one frame as an uncompressed binary VTU file.

    Raises:
        OSError: If the file cannot be written.
    """
    import meshio

    cells: list[tuple[str, Any]] = []
    edges = len(topology.edges)
    parts = []
    for kind, block, part in (
        ("line", topology.edges, slice(None, edges)),
        ("triangle", topology.triangles, slice(edges, None)),
    ):
        if len(block):
            cells.append((kind, block))
            parts.append(part)
    arrays: list[tuple[FieldSpec, Any]] = [
        (DISPLACEMENT, frame.positions - topology.rest_positions),
        *mesh_arrays(topology),
        *((field, frame.fields[field.name]) for field in topology.fields),
    ]
    point_data = {array_name(field): values for field, values in arrays if field.location == "node"}
    cell_data = {
        array_name(field): [np.ascontiguousarray(values[part]) for part in parts]
        for field, values in arrays
        if field.location == "cell" and parts
    }
    mesh = meshio.Mesh(frame.positions, cells, point_data=point_data, cell_data=cell_data)
    meshio.write(path, mesh, file_format="vtu", compression=None)
