"""The part of a run file that ParaView reads: temporal VTKHDF PolyData with a static topology.

Rod edges are two-point lines and shell triangles are polygons, in this order, so that cell data is
"edges first, then triangles" on disk as in memory. Connectivity is stored once; the offsets of every
step point to it. Reference: VTK File Formats, "VTKHDF format specification", version 2.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import IntArray
from ..frame import FieldSpec, Frame, Topology
from ..viewer import array_name, mesh_arrays
from .column import Column, create_column, open_column

ROOT = "VTKHDF"
TIMES = "VTKHDF/Steps/Values"
POINTS = "VTKHDF/Points"

# The cells of a step, in the order the format fixes: vertices, lines, polygons, strips.
_KINDS = ("Vertices", "Lines", "Polygons", "Strips")

Value = Callable[[Frame, int], ArrayLike]
"""What a column stores for a frame and its row number."""

ColumnPlan = tuple[str, int, tuple[int, ...], str, Mapping[str, str | int], Value]
"""Path, rows per frame, shape of a row, type, attributes, value."""


def field_path(field: FieldSpec) -> str:
    """Path of the dataset that holds ``field``."""
    return f"{ROOT}/{_data_group(field)}/{array_name(field)}"


def present(file: Any, path: str) -> str:
    """The path in this file: older ones name their arrays without units."""
    return path if path in file else path.partition(" [")[0]


def write_static(file: Any, topology: Topology) -> None:
    """Write everything of the VTKHDF group that no frame changes."""
    root = file.create_group(ROOT)
    root.attrs["Version"] = np.array([2, 3], dtype=np.int64)
    # VTK wants a fixed-length ASCII string here; h5py's default is variable-length UTF-8.
    root.attrs["Type"] = np.bytes_("PolyData")
    root["NumberOfPoints"] = np.array([len(topology.rest_positions)], dtype=np.int64)
    none = np.empty((0, 1), dtype=np.int64)
    for kind, cells in zip(_KINDS, (none, topology.edges, topology.triangles, none), strict=True):
        _write_cells(root.create_group(kind), cells)
    root.create_group("Steps").attrs["NSteps"] = np.int64(0)
    for field, values in mesh_arrays(topology):
        dataset = root.create_dataset(f"{_data_group(field)}/{array_name(field)}", data=values)
        dataset.attrs.update({"units": field.unit, "long_name": field.long_name})


def _write_cells(group: Any, cells: IntArray) -> None:
    group["NumberOfCells"] = np.array([len(cells)], dtype=np.int64)
    group["NumberOfConnectivityIds"] = np.array([cells.size], dtype=np.int64)
    group["Connectivity"] = np.ascontiguousarray(cells, dtype=np.int64).ravel()
    group["Offsets"] = np.arange(len(cells) + 1, dtype=np.int64) * cells.shape[1]


def plan_columns(topology: Topology) -> Iterator[ColumnPlan]:
    """Yield the columns of the VTKHDF group: step tables, positions and fields."""
    nodes = len(topology.rest_positions)
    cells = len(topology.edges) + len(topology.triangles)
    steps = f"{ROOT}/Steps"
    no_cells = np.zeros(len(_KINDS), dtype=np.int64)
    yield TIMES, 1, (), "f8", {"units": "s", "long_name": "time"}, lambda frame, row: frame.t
    yield f"{steps}/NumberOfParts", 1, (), "i8", {}, lambda frame, row: 1
    yield f"{steps}/PartOffsets", 1, (), "i8", {}, lambda frame, row: 0
    yield f"{steps}/PointOffsets", 1, (), "i8", {}, lambda frame, row: row * nodes
    yield f"{steps}/CellOffsets", 1, (len(_KINDS),), "i8", {}, lambda frame, row: no_cells
    yield f"{steps}/ConnectivityIdOffsets", 1, (len(_KINDS),), "i8", {}, lambda frame, row: no_cells
    attributes = {"units": "m", "long_name": "node positions"}
    yield POINTS, nodes, (3,), "f8", attributes, lambda frame, row: frame.positions
    for field in topology.fields:
        rows = nodes if field.location == "node" else cells
        tail = () if field.components == 1 else (field.components,)
        attributes = {"units": field.unit, "long_name": field.long_name}
        yield field_path(field), rows, tail, "f8", attributes, _field_value(field.name)
        yield _offsets_path(field), 1, (), "i8", {}, _row_offset(rows)


def _offsets_path(field: FieldSpec) -> str:
    return f"{ROOT}/Steps/{_data_group(field)}Offsets/{array_name(field)}"


def _data_group(field: FieldSpec) -> str:
    return "PointData" if field.location == "node" else "CellData"


def _field_value(name: str) -> Value:
    return lambda frame, row: frame.fields[name]


def _row_offset(rows: int) -> Value:
    return lambda frame, row: row * rows


def set_step_count(file: Any, count: int) -> None:
    """Tell VTK how many steps are whole."""
    file[f"{ROOT}/Steps"].attrs.modify("NSteps", np.int64(count))


def whole_frames(file: Any, columns: Sequence[Column]) -> int:
    """Number of frames that are whole: announced, and present in every column."""
    announced = int(file[f"{ROOT}/Steps"].attrs["NSteps"])
    return min([announced, *(column.frames for column in columns)])


def open_columns(file: Any, plans: Iterator[ColumnPlan]) -> list[tuple[Column, Value]]:
    """Find the columns of a file that exists.

    Raises:
        KeyError: If a column is missing.
        ValueError: If a column has another shape.
    """
    columns = []
    for path, rows, tail, _, _, value in plans:
        dataset = file[present(file, path)]
        if dataset.shape[1:] != tail:
            raise ValueError(f"{path} has rows of shape {dataset.shape[1:]}, not {tail}")
        columns.append((open_column(dataset, rows), value))
    return columns


def create_columns(file: Any, plans: Iterator[ColumnPlan]) -> list[tuple[Column, Value]]:
    """Make all planned columns, empty."""
    return [
        (create_column(file, path, rows, tail, dtype, **attributes), value)
        for path, rows, tail, dtype, attributes, value in plans
    ]
