"""VTK's older files (.vtk): unstructured grids and polygons, text or binary."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ...frozen import frozen
from ..allowed import PLAIN, Allowed
from ..limits import check_count
from ..mesh import Mesh
from .source import load_bytes
from .vtk_cells import POLYGON, POLYLINE, STRIP, VERTEX, VtkMesh, mesh_of_vtk
from .vtk_stream import VtkStream, starts

_KINDS = {"VERTICES": VERTEX, "LINES": POLYLINE, "TRIANGLE_STRIPS": STRIP, "POLYGONS": POLYGON, "CELLS": 0}
_ORDER = (0, VERTEX, POLYLINE, POLYGON, STRIP)
_HEAD = re.compile(
    rb"# vtk DataFile Version \d+\.\d+[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s*\n\s*DATASET\s+(\w+)\s*\n",
    re.IGNORECASE,
)
_COMPONENTS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9}


def read_vtk_legacy(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read an unstructured grid or polygons in VTK's older format.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_vtk_legacy(load_bytes(path), str(path), allowed)


def parse_vtk_legacy(data: bytes, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the bytes of a VTK file; ``where`` names it in messages.

    Raises:
        MeshError: If the bytes are malformed or describe an unusable mesh.
    """
    match = _HEAD.match(data)
    if match is None:
        raise MeshError(
            f"{where}:1: expected '# vtk DataFile Version', a title, ASCII or BINARY, and DATASET"
        )
    kind = match[2].decode("ascii", "replace").upper()
    if kind not in ("UNSTRUCTURED_GRID", "POLYDATA"):
        raise MeshError(f"{where}: a dataset {kind[:40]}; expected UNSTRUCTURED_GRID or POLYDATA")
    reader = _Reader(VtkStream(data, match.end(), match[1].upper() == b"BINARY", where))
    reader.read_all()
    return mesh_of_vtk(reader.mesh(), where, allowed)


@frozen
class _Cells:
    """Cells of one kind, 0 if each has its own: nodes of all, and where each ends among them."""

    kind: int
    nodes: IntArray
    ends: IntArray


class _Reader:
    """Goes through a file section by section."""

    def __init__(self, stream: VtkStream) -> None:
        self._in = stream
        self._where = stream.where
        self._points: FloatArray = np.empty((0, 3))
        self._cells: list[_Cells] = []
        self._types: IntArray | None = None
        self._values: dict[str, IntArray] = {}
        self._dropped: list[str] = []

    def mesh(self) -> VtkMesh:
        """What was read."""
        none = np.empty(0, dtype=np.int64)
        # Data on polygons count through the kinds in this order, whatever that of the file.
        cells = sorted(self._cells, key=lambda one: _ORDER.index(one.kind))
        offsets = np.cumsum([0, *(len(one.nodes) for one in cells)])
        ends = [one.ends + at for one, at in zip(cells, offsets, strict=False)]
        kinds = [np.full(len(one.ends), one.kind) for one in cells]
        return VtkMesh(
            points=self._points,
            connectivity=np.concatenate([none, *(one.nodes for one in cells)]),
            ends=np.concatenate([none, *ends]),
            types=np.concatenate([none, *kinds]) if self._types is None else self._types,
            values=self._values,
            dropped=self._dropped,
        )

    def read_all(self) -> None:
        """Read the mesh, then the data on it as far as they are known kinds."""
        count, on_cells = 0, False
        while words := self._in.line():
            match [words[0].upper(), *words[1:]]:
                case ["POINTS", number, kind]:
                    total = 3 * check_count(self._in.whole(number), "points", self._where)
                    self._points = self._in.take(total, kind).astype(np.float64).reshape(-1, 3)
                case ["CELLS" | "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" as name, number, size]:
                    self._read_cells(name, self._in.whole(number), self._in.whole(size))
                case ["CELL_TYPES", number]:
                    self._types = self._in.take(self._in.whole(number), "int").astype(np.int64)
                case ["METADATA"]:
                    self._in.skip_metadata()
                case ["CELL_DATA" | "POINT_DATA" as place, number]:
                    count, on_cells = self._in.whole(number), place == "CELL_DATA"
                case ["FIELD", _, number]:
                    self._read_fields(self._in.whole(number), on_cells)
                case ["SCALARS", name, kind, *rest] if len(rest) <= 1:
                    columns = self._in.whole(rest[0]) if rest else 1
                    if not starts(self._in.line(), "LOOKUP_TABLE"):
                        raise MeshError(f"{self._where}: scalars {name[:40]!r} without LOOKUP_TABLE")
                    self._keep(name, self._in.take(count * columns, kind), columns, on_cells)
                case ["VECTORS" | "NORMALS" | "TENSORS" as what, name, kind]:
                    self._keep(name, self._in.take(count * _COMPONENTS[what], kind), 3, on_cells)
                case _ if count:
                    self._dropped.append(f"{' '.join(words)[:40]} and what follows it")
                    return
                case _:
                    raise MeshError(
                        f"{self._where}: {' '.join(words)[:60]!r}; expected POINTS, CELLS or POLYGONS"
                    )

    def _read_cells(self, name: str, number: int, size: int) -> None:
        """Cells with the number of nodes before each, or since 5.1 ends and nodes of all."""
        if self._in.next_starts("OFFSETS"):
            offsets = self._in.take(number, self._in.line()[-1]).astype(np.int64)
            words = self._in.line()
            if not starts(words, "CONNECTIVITY"):
                raise MeshError(f"{self._where}: OFFSETS of {name} without CONNECTIVITY")
            nodes, ends = self._in.take(size, words[-1]).astype(np.int64), offsets[1:]
        else:
            nodes, ends = self._counted(self._in.take(size, "int").astype(np.int64), number)
        self._cells.append(_Cells(_KINDS[name], nodes, ends))

    def _counted(self, flat: IntArray, number: int) -> tuple[IntArray, IntArray]:
        """Nodes and ends of cells each of which has its size before its nodes."""
        check_count(number, "cells", self._where)
        heads, at = [], 0
        values = flat.tolist()
        for cell in range(number):
            if at >= len(values) or values[at] < 0 or at + values[at] >= len(values):
                raise MeshError(f"{self._where}: cell {cell + 1} names more nodes than follow")
            heads.append(at)
            at += 1 + values[at]
        head = np.array(heads, dtype=np.int64)
        inside = np.ones(at, dtype=np.bool_)
        inside[head] = False
        return flat[:at][inside], np.cumsum(flat[head]) if number else head

    def _read_fields(self, number: int, on_cells: bool) -> None:
        for _ in range(min(number, 1000)):
            words = self._in.line()
            if starts(words, "METADATA"):
                self._in.skip_metadata()
                words = self._in.line()
            if len(words) != 4:
                raise MeshError(
                    f"{self._where}: {' '.join(words)[:60]!r}; expected a field: name, sizes, type"
                )
            columns, rows = self._in.whole(words[1]), self._in.whole(words[2])
            self._keep(words[0], self._in.take(columns * rows, words[3]), columns, on_cells)

    def _keep(self, name: str, values: NDArray[Any], columns: int, on_cells: bool) -> None:
        title = unquote(name)
        if on_cells and columns == 1 and values.dtype.kind in "iu":
            self._values[title] = values.astype(np.int64)
        else:
            self._dropped.append(title)
