"""PLY files, text or binary: faces become shell triangles, edges become rod edges."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ...frozen import frozen
from ..allowed import PLAIN, Allowed
from ..limits import check_count
from ..mesh import Mesh
from .cells import Cells, mesh_of_cells
from .ply_rows import BinaryRows, Element, Property, TextRows
from .source import load_bytes

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS = ("vertex_indices", "vertex_index")
_MAX_HEAD = 1 << 16


def read_ply(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read a PLY mesh: vertices, faces and edges; colours, normals and the like are dropped and told.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_ply(load_bytes(path), str(path), allowed)


def parse_ply(data: bytes, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the bytes of a PLY file; ``where`` names it in messages.

    Raises:
        MeshError: If the bytes are malformed or describe an unusable mesh.
    """
    head = _head(data, where)
    rows = (
        BinaryRows(data, head.size, head.order, where)
        if head.order
        else TextRows(data[head.size :].decode("utf-8", "replace"), head.lines, where)
    )
    nodes: FloatArray = np.empty((0, 3))
    polygons, polylines, dropped = Cells(), Cells(), []
    for element in head.elements:
        check_count(element.count, f"elements {element.name!r}", where)
        table = rows.read(element)
        match element.name:
            case "vertex":
                nodes = np.stack([_column(table.scalars, axis, where) for axis in "xyz"], axis=1)
                used: tuple[str, ...] = ("x", "y", "z")
            case "face":
                name = next((one for one in _CORNERS if one in table.lists), None)
                if name is None and element.count:
                    raise MeshError(f"{where}: faces without a list 'vertex_indices'")
                if name is not None:
                    polygons = Cells(nodes=table.lists[name], ends=table.ends[name], lines=table.lines)
                used = _CORNERS
            case "edge":
                ends = [_column(table.scalars, name, where) for name in ("vertex1", "vertex2")]
                polylines = _segments(np.stack(ends, axis=1), table.lines, where)
                used = ("vertex1", "vertex2")
            case "tristrips":
                raise MeshError(f"{where}: strips of triangles; save the mesh as single triangles")
            case _:
                dropped.append(f"elements {element.name!r}")
                continue
        dropped += [f"{one.name!r}" for one in element.properties if one.name not in used]
    notes = (f"{', '.join(dict.fromkeys(dropped))} dropped.",) if dropped else ()
    return mesh_of_cells(nodes, polygons, polylines, notes, where, allowed)


def _column(scalars: dict[str, NDArray[np.float64]], name: str, where: str) -> NDArray[np.float64]:
    if name not in scalars:
        raise MeshError(f"{where}: no property {name!r}; found: {', '.join(scalars) or 'none'}")
    return scalars[name]


def _segments(ends: FloatArray, lines: IntArray | None, where: str) -> Cells:
    with np.errstate(invalid="ignore"):
        whole = np.where(np.abs(ends) < 2**53, ends, -1.0)
        numbers = whole.astype(np.int64)
    if (numbers != whole).any():
        raise MeshError(f"{where}: an edge names a node by a number that is not whole")
    return Cells(nodes=numbers.reshape(-1), ends=2 * np.arange(1, len(ends) + 1), lines=lines)


@frozen
class _Head:
    """What a file announces: byte order (empty for text), elements, and the size of the head."""

    order: str
    elements: list[Element]
    size: int
    lines: int


def _head(data: bytes, where: str) -> _Head:
    end = data.find(b"end_header", 0, _MAX_HEAD)
    if not data.startswith(b"ply") or end < 0:
        raise MeshError(f"{where}:1: no head from 'ply' to 'end_header'; not a PLY file")
    text = data[:end].decode("utf-8", "replace").replace("\r\n", "\n").replace("\r", "\n")
    order, elements = None, list[Element]()
    for number, line in enumerate(text.split("\n")[1:], start=2):
        place = f"{where}:{number}"
        match line.split():
            case [] | ["comment" | "obj_info", *_]:
                continue
            case ["format", kind, "1.0"] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 18:
                elements.append(Element(name, int(count), []))
            case ["property", "list", length, kind, name] if {length, kind} <= _TYPES.keys() and elements:
                elements[-1].properties.append(Property(name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if kind in _TYPES and elements:
                elements[-1].properties.append(Property(name, _TYPES[kind], None))
            case _:
                raise MeshError(f"{place}: {line[:60]!r}; expected format, element, property or comment")
    if order is None:
        raise MeshError(f"{where}:2: no format; expected one of {', '.join(_ORDERS)}, version 1.0")
    size = end + len(b"end_header")
    size += 2 if data[size : size + 2] == b"\r\n" else 1
    return _Head(order, elements, size, text.count("\n") + 1)
