"""VTK's XML files: unstructured grids (.vtu) and polygons (.vtp)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray, IntArray
from ...errors import MeshError
from ..allowed import PLAIN, Allowed
from ..mesh import Mesh
from .source import load_bytes
from .vtk_arrays import ArrayReader
from .vtk_cells import POLYGON, POLYLINE, STRIP, VERTEX, VtkMesh, mesh_of_vtk

_KINDS = (("Verts", VERTEX), ("Lines", POLYLINE), ("Polys", POLYGON), ("Strips", STRIP))


def read_vtk_xml(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read an unstructured grid or polygons in VTK's XML format.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_vtk_xml(load_bytes(path), str(path), allowed)


def parse_vtk_xml(data: bytes, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the bytes of a VTK XML file; ``where`` names it in messages.

    Raises:
        MeshError: If the bytes are malformed or describe an unusable mesh.
    """
    root, appended, raw = _tree(data, where)
    arrays = ArrayReader.of(root, appended, raw, where)
    kind = root.get("type", "")
    grid = root.find(kind) if kind in ("UnstructuredGrid", "PolyData") else None
    if grid is None:
        raise MeshError(f"{where}: a VTK file of type {kind[:40]!r}; expected UnstructuredGrid or PolyData")
    pieces = [_piece(piece, arrays, kind == "PolyData", where) for piece in grid.findall("Piece")]
    if not pieces:
        raise MeshError(f"{where}: no piece of a grid")
    return mesh_of_vtk(_together(pieces), where, allowed)


def _tree(data: bytes, where: str) -> tuple[ET.Element, bytes, bool]:
    """The elements, the appended data, and whether these are raw: then the file is no XML behind them."""
    appended, raw = b"", False
    start = data.find(b"<AppendedData")
    if start >= 0:
        body = data.find(b">", start) + 1
        raw = b"raw" in data[start:body]
        end = data.rfind(b"</AppendedData>")
        appended = data[data.find(b"_", body) + 1 : end if end > body else len(data)]
        data = data[:start] + b"</VTKFile>"
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise MeshError(f"{where}: declares entities, which no VTK file needs")
    try:
        root = ET.fromstring(data)
    except (ET.ParseError, ValueError, LookupError) as error:
        raise MeshError(f"{where}: not an XML file of VTK ({error})") from None
    if root.tag != "VTKFile":
        raise MeshError(f"{where}:1: root {root.tag[:40]!r}; expected VTKFile")
    return root, appended, raw


def _piece(piece: ET.Element, arrays: ArrayReader, polygons: bool, where: str) -> VtkMesh:
    points = piece.find("Points/DataArray")
    if points is None:
        raise MeshError(f"{where}: a piece without points")
    flat = arrays.read(points).astype(np.float64)
    if len(flat) % 3:
        raise MeshError(f"{where}: {len(flat)} coordinates; expected three of each point")
    parts = (
        [_cells(piece, name, kind, arrays) for name, kind in _KINDS] if polygons else [_grid(piece, arrays)]
    )
    offsets = np.cumsum([0, *(len(nodes) for nodes, _, _ in parts)])
    values, dropped = _values(piece, arrays)
    return VtkMesh(
        points=flat.reshape(-1, 3),
        connectivity=np.concatenate([nodes for nodes, _, _ in parts]),
        ends=np.concatenate([ends + offset for (_, ends, _), offset in zip(parts, offsets, strict=False)]),
        types=np.concatenate([types for _, _, types in parts]),
        values=values,
        dropped=dropped,
    )


def _grid(piece: ET.Element, arrays: ArrayReader) -> tuple[IntArray, IntArray, IntArray]:
    """Connectivity, ends and types of the cells of an unstructured grid."""
    found = [arrays.named(piece, "Cells", name) for name in ("connectivity", "offsets", "types")]
    return found[0], found[1], found[2]


def _cells(
    piece: ET.Element, name: str, kind: int, arrays: ArrayReader
) -> tuple[IntArray, IntArray, IntArray]:
    """Those of one kind of polygons."""
    if piece.find(name) is None:
        none = np.empty(0, dtype=np.int64)
        return none, none, none
    connectivity, ends = (arrays.named(piece, name, what) for what in ("connectivity", "offsets"))
    return connectivity, ends, np.full(len(ends), kind)


def _values(piece: ET.Element, arrays: ArrayReader) -> tuple[dict[str, IntArray], list[str]]:
    """Whole numbers on cells by name, and names of all other data."""
    values: dict[str, IntArray] = {}
    dropped = [array.get("Name", "?") for array in piece.findall("PointData/DataArray")]
    for array in piece.findall("CellData/DataArray"):
        name, kind = array.get("Name", "?"), array.get("type", "")
        if "Int" in kind and array.get("NumberOfComponents", "1") in ("", "1"):
            values[name] = arrays.read(array).astype(np.int64)
        else:
            dropped.append(name)
    return values, dropped


def _together(pieces: list[VtkMesh]) -> VtkMesh:
    if len(pieces) == 1:
        return pieces[0]
    nodes = np.cumsum([0, *(len(piece.points) for piece in pieces)])
    places = np.cumsum([0, *(len(piece.connectivity) for piece in pieces)])
    shared = set.intersection(*(set(piece.values) for piece in pieces))

    def joined(parts: Iterator[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate(list(parts))

    points: FloatArray = joined(piece.points for piece in pieces)
    return VtkMesh(
        points=points,
        connectivity=joined(p.connectivity + n for p, n in zip(pieces, nodes, strict=False)),
        ends=joined(p.ends + n for p, n in zip(pieces, places, strict=False)),
        types=joined(piece.types for piece in pieces),
        values={name: joined(piece.values[name] for piece in pieces) for name in sorted(shared)},
        dropped=[
            *(name for piece in pieces for name in piece.dropped),
            *(name for piece in pieces for name in piece.values if name not in shared),
        ],
    )
