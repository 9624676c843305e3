"""gmsh files, versions 2.2 and 4.1: lines become rod edges, triangles and quads become shells."""

from __future__ import annotations

import contextlib
import io
import re
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import IntArray
from ...errors import MeshError
from ...file_text import decode
from ...frozen import frozen
from ..allowed import PLAIN, Allowed
from ..mesh import Mesh
from ..topology.sides import half_edges
from ..validate import validate
from .gmsh_guard import Guarded, guard
from .groups import GroupBuilder
from .polygon import triangulate
from .source import load_bytes

_DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2}
_FOREIGN = re.compile(rb"\xff\xfe|\xfe\xff|(?:\xef\xbb\xbf)?\$MeshFormat[ \t]*\r(?!\n)")
_UNNAMED = ("point", "curve", "surface")


def read_gmsh(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read a gmsh mesh, version 2.2 or 4.1, text or binary.

    Physical groups become groups of nodes, edges and triangles. A line that is a side of a
    triangle is a boundary, not a rod: it gives its nodes to the group and nothing else.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_gmsh(_plain(load_bytes(path)), str(path), allowed)


def _plain(data: bytes) -> bytes:
    """A text in UTF-16 or with carriage returns as gmsh would write it; bytes stay as they are."""
    return decode(data, "replace").encode() if _FOREIGN.match(data) else data


def parse_gmsh(data: bytes, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the bytes of a gmsh file; ``where`` names it in messages.

    Raises:
        MeshError: If the bytes are malformed or describe an unusable mesh.
    """
    guarded = guard(data, where)
    return _assemble(_read(guarded.data, where), guarded, where, allowed)


def _read(data: bytes, where: str) -> Any:
    """Return meshio's mesh; it reads from files only."""
    import meshio

    try:
        with (
            tempfile.TemporaryDirectory() as folder,
            warnings.catch_warnings(),
            # It tells the terminal of tags beyond two, which are partitions.
            contextlib.redirect_stderr(io.StringIO()),
            contextlib.redirect_stdout(io.StringIO()),
        ):
            # Numbers that end early are no more than a warning of numpy.
            warnings.simplefilter("error")
            path = Path(folder) / "mesh.msh"
            path.write_bytes(data)
            return meshio.gmsh.read(path)
    except Exception as error:
        raise MeshError(f"{where}: meshio cannot read it ({type(error).__name__}: {error})") from error


@frozen
class _Table:
    """Elements of one dimension: node indices, shape (rows, 2 or 3), and the groups of each row."""

    rows: IntArray
    names: list[tuple[str, ...]]

    def keep(self, which: IntArray) -> _Table:
        """Return the chosen rows."""
        return _Table(self.rows[which], [self.names[i] for i in which])

    def groups(self) -> dict[str, IntArray]:
        """Return the row indices under each name."""
        builder = GroupBuilder()
        for index, names in enumerate(self.names):
            builder.add(names, (index,))
        return builder.build()


def _assemble(source: Any, guarded: Guarded, where: str, allowed: Allowed) -> Mesh:
    """Build and validate the mesh from meshio's cell blocks."""
    members = GroupBuilder()
    blocks: dict[int, list[_Table]] = {
        1: [_Table(np.empty((0, 2), dtype=np.int64), [])],
        2: [_Table(np.empty((0, 3), dtype=np.int64), [])],
    }
    quads = 0
    for number, cells in enumerate(source.cells):
        rows, dimension = np.asarray(cells.data, dtype=np.int64), _DIMENSIONS[cells.type]
        names = _titles(source, guarded, number, dimension)
        for row, titles in zip(rows.tolist(), names, strict=True):
            members.add(titles, row)
        if cells.type == "quad":
            quads += len(rows)
            rows, names = _split(source.points, rows), [titles for titles in names for _ in range(2)]
        if dimension > 0:
            blocks[dimension].append(_Table(rows, names))
    notes = [f"{quads} quads split into triangles."] if quads else []
    faces = _merge_repeats(_stack(blocks[2]))
    rods = _drop_sides(_merge_repeats(_stack(blocks[1])), faces.rows, notes)
    mesh = Mesh(
        nodes=np.asarray(source.points, dtype=np.float64).reshape(-1, 3),
        edges=rods.rows,
        triangles=faces.rows,
        node_groups=members.build(),
        edge_groups=rods.groups(),
        triangle_groups=faces.groups(),
        notes=tuple(notes),
    )
    return validate(mesh, where, allowed=allowed)


def _titles(source: Any, guarded: Guarded, number: int, dimension: int) -> list[tuple[str, ...]]:
    """Return the group names of each element of a block."""
    count = len(source.cells[number].data)
    if guarded.block_groups is not None:
        tags = [guarded.block_groups[number]] * count
    elif "gmsh:physical" in source.cell_data:
        # A tag of 0 means none.
        tags = [(abs(tag),) if tag else () for tag in source.cell_data["gmsh:physical"][number].tolist()]
    else:
        tags = [()] * count
    unnamed = _UNNAMED[dimension]
    return [tuple(guarded.names.get((dimension, tag), f"{unnamed}_{tag}") for tag in row) for row in tags]


def _split(points: Any, rows: IntArray) -> IntArray:
    with np.errstate(over="ignore", invalid="ignore"):
        pieces = [row[list(triple)] for row in rows for triple in triangulate(points[row])]
    return np.array(pieces, dtype=np.int64).reshape(-1, 3)


def _stack(tables: list[_Table]) -> _Table:
    rows = np.concatenate([table.rows for table in tables])
    return _Table(rows, [names for table in tables for names in table.names])


def _merge_repeats(table: _Table) -> _Table:
    """Unite identical elements: version 2.2 writes one copy for each physical group."""
    _, first, inverse = np.unique(np.sort(table.rows, axis=1), axis=0, return_index=True, return_inverse=True)
    if len(first) == len(table.rows):
        return table
    keep = np.sort(first)
    names: dict[int, dict[str, None]] = {int(i): {} for i in keep}
    repeated: set[tuple[int, str]] = set()
    for index, row in enumerate(inverse.ravel()):
        original = int(first[row])
        clash = {(original, name) for name in table.names[index] or ("",)}
        # Twice in the same group is no bookkeeping of gmsh but an error; validation names it.
        if clash & repeated:
            return table
        repeated |= clash
        names[original].update(dict.fromkeys(table.names[index]))
    return _Table(table.rows[keep], [tuple(names[int(i)]) for i in keep])


def _drop_sides(rods: _Table, triangles: IntArray, notes: list[str]) -> _Table:
    """Leave out lines that are sides of triangles: gmsh saves the boundary curves of surfaces."""
    if not len(rods.rows) or not len(triangles):
        return rods
    count = int(max(rods.rows.max(), triangles.max())) + 1
    sides = np.sort(half_edges(triangles), axis=1) @ np.array([count, 1])
    side = np.isin(np.sort(rods.rows, axis=1) @ np.array([count, 1]), sides)
    if side.any():
        notes.append(f"{int(side.sum())} lines along triangle sides taken as boundaries, not as rods.")
    return rods.keep(np.flatnonzero(~side))
