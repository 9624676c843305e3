"""From gmsh's element tables to a mesh with groups."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import IntArray
from ..errors import MeshError
from .gmsh_sections import SUPPORTED, Block, Nodes
from .groups import GroupBuilder
from .mesh import Mesh
from .orient import half_edges
from .polygon import triangulate
from .source import Lines
from .validate import validate

Names = dict[tuple[int, int], str]
"""Name of each (dimension, physical tag)."""

_UNNAMED = ("point", "curve", "surface")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Table:
    """Elements of one dimension with the group names of each.

    Attributes:
        rows: Node indices, shape (rows, 2 or 3).
        lines: Line numbers, shape (rows,), or None.
        names: Group names of each row.
    """

    rows: IntArray
    lines: IntArray | None
    names: tuple[tuple[str, ...], ...]

    def keep(self, which: IntArray) -> _Table:
        """Return the chosen rows."""
        return _Table(
            rows=self.rows[which],
            lines=None if self.lines is None else self.lines[which],
            names=tuple(self.names[i] for i in which),
        )

    def groups(self) -> dict[str, IntArray]:
        """Return the row indices under each name."""
        builder = GroupBuilder()
        for index, names in enumerate(self.names):
            builder.add(names, (index,))
        return builder.build()


def assemble(nodes: Nodes, blocks: list[Block], names: Names, where: str) -> Mesh:
    """Build and validate the mesh of a gmsh file.

    Raises:
        MeshError: If an element names a node that the file does not define, or the mesh is unusable.
    """
    index = _node_index(nodes, where)
    node_members = GroupBuilder()
    edges, triangles = [_empty(2)], [_empty(3)]
    quads = 0
    for block in blocks:
        dimension = SUPPORTED[block.kind][1]
        titles = tuple(names.get((dimension, tag), f"{_UNNAMED[dimension]}_{tag}") for tag in block.physical)
        rows = _lookup(index, block, where)
        node_members.add(titles, rows.ravel().tolist())
        repeat = 1
        if block.kind == 3:
            quads += len(rows)
            repeat = 2
            rows = _split_quads(nodes, rows)
        lines = None if block.lines is None else np.repeat(block.lines, repeat)
        if dimension > 0:
            table = _Table(rows=rows, lines=lines, names=(titles,) * len(rows))
            (edges if dimension == 1 else triangles).append(table)
    notes = [f"{quads} quads split into triangles."] if quads else []
    faces = _merge_repeats(_stack(triangles))
    rods = _drop_sides(_merge_repeats(_stack(edges)), faces.rows, notes)
    mesh = Mesh(
        nodes=nodes.points,
        edges=rods.rows,
        triangles=faces.rows,
        node_groups=node_members.build(),
        edge_groups=rods.groups(),
        triangle_groups=faces.groups(),
        notes=tuple(notes),
    )
    return validate(mesh, where, Lines(nodes=nodes.lines, edges=rods.lines, triangles=faces.lines))


def _empty(width: int) -> _Table:
    return _Table(rows=np.empty((0, width), dtype=np.int64), lines=np.empty(0, dtype=np.int64), names=())


def _stack(tables: list[_Table]) -> _Table:
    lines = [table.lines for table in tables if table.lines is not None]
    return _Table(
        rows=np.concatenate([table.rows for table in tables]),
        lines=np.concatenate(lines) if len(lines) == len(tables) else None,
        names=tuple(names for table in tables for names in table.names),
    )


def _node_index(nodes: Nodes, where: str) -> tuple[IntArray, IntArray]:
    """Return sorted node tags and the index of each.

    Tags are sparse and unordered, so a table from tag to index could be of any size.
    """
    order = np.argsort(nodes.tags, kind="stable")
    tags = nodes.tags[order]
    twice = np.flatnonzero(tags[1:] == tags[:-1])
    if len(twice):
        node = int(order[twice[0] + 1])
        place = where if nodes.lines is None else f"{where}:{nodes.lines[node]}"
        raise MeshError(f"{place}: node number {tags[twice[0]]} is defined twice")
    return tags, order


def _lookup(index: tuple[IntArray, IntArray], block: Block, where: str) -> IntArray:
    """Replace node tags by node indices."""
    tags, order = index
    slot = np.minimum(np.searchsorted(tags, block.tags), max(len(tags) - 1, 0))
    known = tags[slot] == block.tags if len(tags) else np.zeros(block.tags.shape, dtype=np.bool_)
    if not known.all():
        row, column = (int(v) for v in np.argwhere(~known)[0])
        place = where if block.lines is None else f"{where}:{block.lines[row]}"
        raise MeshError(
            f"{place}: element names node {block.tags[row, column]}, which the file does not define"
        )
    return order[slot]


def _split_quads(nodes: Nodes, rows: IntArray) -> IntArray:
    with np.errstate(over="ignore", invalid="ignore"):
        pieces = [row[list(triple)] for row in rows for triple in triangulate(nodes.points[row])]
    return np.array(pieces, dtype=np.int64).reshape(-1, 3)


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
    kept = table.keep(keep)
    return _Table(rows=kept.rows, lines=kept.lines, names=tuple(tuple(names[int(i)]) for i in keep))


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
