"""Meshes from polygons, polylines and the numbers on them: what PLY, OFF and VTK files hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...errors import MeshError
from ...frozen import frozen
from ..allowed import Allowed
from ..limits import MAX_COUNT, check_count
from ..mesh import Mesh
from ..topology.sides import half_edges
from ..validate import Lines, validate
from .polygon import MAX_CORNERS, triangulate


def _none() -> IntArray:
    return np.empty(0, dtype=np.int64)


@frozen(kw_only=True)
class Cells:
    """Polygons, or polylines, one after another.

    Attributes:
        nodes: Node indices of all, shape (K,).
        ends: Where each one ends among them, ascending, shape (C,).
        groups: Names of sets of them.
        lines: Line of the file of each, shape (C,), or None.
    """

    nodes: IntArray = field(default_factory=_none)
    ends: IntArray = field(default_factory=_none)
    groups: Mapping[str, IntArray] = field(default_factory=dict)
    lines: IntArray | None = None

    @property
    def starts(self) -> IntArray:
        """Where each one starts, shape (C,)."""
        return np.concatenate(([0], self.ends[:-1])) if len(self.ends) else self.ends

    def place(self, cell: int, where: str) -> str:
        """The line of a cell for a message, or its number."""
        return f"{where}:{self.lines[cell]}" if self.lines is not None else f"{where}: cell {cell + 1}"


def mesh_of_cells(
    nodes: FloatArray, polygons: Cells, polylines: Cells, notes: tuple[str, ...], where: str, allowed: Allowed
) -> Mesh:
    """Cut polygons into triangles and polylines into edges, and validate.

    A line that is a side of a triangle is a boundary, not a rod.

    Args:
        nodes: Positions, shape (N, 3).
        polygons: Faces.
        polylines: Lines.
        notes: What the reader wants said.
        where: Names the file in messages.
        allowed: What the mesh may be beyond a plain surface.

    Raises:
        MeshError: A cell has too few or too many nodes or names none, or the mesh is unusable.
    """
    for cells, least, most in ((polygons, 3, MAX_CORNERS), (polylines, 2, MAX_COUNT)):
        _check(cells, len(nodes), least, most, where)
    triangles, face = _triangles(nodes, polygons)
    edges, line = _edges(polylines)
    cut = len(triangles) - len(polygons.ends)
    told = [*notes]
    if cut:
        count = int((np.bincount(face) > 1).sum())
        told.append(f"{count} {'polygon' if count == 1 else 'polygons'} split into triangles.")
    side = _sides(edges, triangles)
    if side.any():
        told.append(f"{int(side.sum())} lines along triangle sides taken as boundaries, not as rods.")
    node_groups = {name: distinct(edges[np.isin(line, group)]) for name, group in polylines.groups.items()}
    kept = np.flatnonzero(~side)
    mesh = Mesh(
        nodes=nodes,
        edges=edges[kept],
        triangles=triangles,
        node_groups={name: group for name, group in node_groups.items() if group.size},
        edge_groups=_grouped(polylines.groups, line[kept]),
        triangle_groups=_grouped(polygons.groups, face),
        notes=tuple(told),
    )
    lines = Lines(
        edges=None if polylines.lines is None else polylines.lines[line[kept]],
        triangles=None if polygons.lines is None else polygons.lines[face],
    )
    return validate(mesh, where, lines, allowed)


def _check(cells: Cells, count: int, least: int, most: int, where: str) -> None:
    sizes = np.diff(cells.ends, prepend=0)
    bad = (sizes < least) | (sizes > most)
    if bad.any():
        cell = int(np.argmax(bad))
        raise MeshError(
            f"{cells.place(cell, where)}: a cell of {sizes[cell]} nodes; expected {least} to {most}"
        )
    check_count(int((sizes - least + 1).sum()), "triangles or edges", where)
    outside = (cells.nodes < 0) | (cells.nodes >= count)
    if outside.any():
        at = int(np.argmax(outside))
        cell = int(np.searchsorted(cells.ends, at, side="right"))
        raise MeshError(
            f"{cells.place(cell, where)}: node number {cells.nodes[at]}; the file has {count} nodes, counted "
            "from 0"
        )


def _triangles(nodes: FloatArray, polygons: Cells) -> tuple[IntArray, IntArray]:
    """Triangles (T, 3), and the polygon of each (T,)."""
    sizes = np.diff(polygons.ends, prepend=0)
    if (sizes == 3).all():
        return polygons.nodes.reshape(-1, 3), np.arange(len(sizes))
    pieces: list[IntArray] = []
    for start, end in zip(polygons.starts.tolist(), polygons.ends.tolist(), strict=True):
        corners = polygons.nodes[start:end]
        if len(corners) == 3:
            pieces.append(corners[None])
            continue
        with np.errstate(over="ignore", invalid="ignore"):
            pieces.append(corners[np.array(triangulate(nodes[corners]))])
    return np.concatenate(pieces), np.repeat(np.arange(len(sizes)), sizes - 2)


def _edges(polylines: Cells) -> tuple[IntArray, IntArray]:
    """Edges (E, 2), and the polyline of each (E,)."""
    sizes = np.diff(polylines.ends, prepend=0)
    first = np.ones(len(polylines.nodes), dtype=np.bool_)
    first[polylines.ends - 1] = False
    start = np.flatnonzero(first)
    edges = np.stack((polylines.nodes[start], polylines.nodes[np.minimum(start + 1, len(first) - 1)]), axis=1)
    return edges.reshape(-1, 2), np.repeat(np.arange(len(sizes)), sizes - 1)


def _sides(edges: IntArray, triangles: IntArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """True for edges that are sides of triangles, shape (E,)."""
    if not (len(edges) and len(triangles)):
        return np.zeros(len(edges), dtype=np.bool_)
    weights = np.array([int(max(edges.max(), triangles.max())) + 1, 1])
    sides = np.sort(half_edges(triangles), axis=1) @ weights
    return np.isin(np.sort(edges, axis=1) @ weights, sides)


def _grouped(groups: Mapping[str, IntArray], owner: IntArray) -> dict[str, IntArray]:
    """Groups of cells as groups of the pieces that they were cut into."""
    found = {name: np.flatnonzero(np.isin(owner, group)) for name, group in groups.items()}
    return {name: group for name, group in found.items() if group.size}


MOST_VALUES = 100
"""More different whole numbers on cells are data, not names of parts."""


def groups_by_value(name: str, values: IntArray) -> dict[str, IntArray]:
    """One group ``name_VALUE`` for each of a few whole numbers on cells; none if they are many or one."""
    distinct, index = np.unique(values, return_inverse=True)
    if not 1 < len(distinct) <= MOST_VALUES:
        return {}
    return {f"{name}_{value}": np.flatnonzero(index == k) for k, value in enumerate(distinct.tolist())}
