"""The sections of gmsh 2.2 and 4.1 files, text or binary, as node and element tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import MeshError
from .gmsh_cursor import Cursor
from .source import check_count

# gmsh element number: (nodes, dimension). Higher-order and solid elements are refused by name.
SUPPORTED = {15: (1, 0), 1: (2, 1), 2: (3, 2), 3: (4, 2)}
_REFUSED = {
    "higher-order elements; set Mesh.ElementOrder = 1": (8, 9, 10, 16, 20, 21, 22, 23, 24, 25, 26, 27, 28),
    "solid elements; mesh surfaces and curves only": (4, 5, 6, 7, 11, 12, 13, 14, 17, 18, 19, 29, 30, 31),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Nodes:
    """Tags, shape (N,), positions [m], shape (N, 3), and line numbers if the file is text."""

    tags: IntArray
    points: FloatArray
    lines: IntArray | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Elements of one kind and one set of physical groups, in file order.

    Attributes:
        kind: gmsh element number: 15 point, 1 line, 2 triangle, 3 quad.
        physical: Tags of the physical groups.
        tags: Node tags, shape (rows, nodes of the kind).
        lines: Line numbers, shape (rows,), if the file is text.
    """

    kind: int
    physical: tuple[int, ...]
    tags: IntArray
    lines: IntArray | None


Entities = dict[tuple[int, int], tuple[int, ...]]
"""Physical groups of each (dimension, entity)."""


def element_width(kind: int, place: str) -> int:
    """Return the number of nodes of an element.

    Raises:
        MeshError: If this program does not simulate such elements.
    """
    if kind in SUPPORTED:
        return SUPPORTED[kind][0]
    for why, kinds in _REFUSED.items():
        if kind in kinds:
            raise MeshError(f"{place}: {why} (gmsh element type {kind})")
    raise MeshError(f"{place}: unknown gmsh element type {kind}; expected points, lines, triangles or quads")


def read_nodes41(cursor: Cursor) -> Nodes:
    """Read ``$Nodes`` of version 4.1."""
    blocks, count = (int(v) for v in cursor.sizes(4)[:2])
    check_count(count, "nodes", cursor.place(0))
    tags, points, lines = [], [], []
    for _ in range(blocks):
        start = cursor.position
        parametric = int(cursor.ints(3)[2])
        rows = int(cursor.sizes(1)[0])
        if parametric != 0:
            raise MeshError(f"{cursor.place(start)}: parametric nodes; set Mesh.SaveParametric = 0")
        tags.append(cursor.sizes(rows))
        first = cursor.position
        points.append(cursor.doubles(3 * rows).reshape(rows, 3))
        lines.append(cursor.lines(first + 3 * np.arange(rows)))
    found = sum(map(len, tags))
    if found != count:
        raise MeshError(f"{cursor.place(0)}: {count} nodes announced, {found} found")
    return Nodes(
        tags=_join(tags),
        points=np.concatenate([np.empty((0, 3)), *points]),
        lines=_join_lines(lines),
    )


def read_entities41(cursor: Cursor) -> Entities:
    """Read ``$Entities`` of version 4.1: which entity belongs to which physical groups."""
    groups: Entities = {}
    for dimension, count in enumerate(cursor.sizes(4)):
        for _ in range(int(count)):
            tag = int(cursor.ints(1)[0])
            cursor.doubles(3 if dimension == 0 else 6)
            # A negative tag says that gmsh reversed the entity; the group is the same.
            groups[dimension, tag] = tuple(int(abs(v)) for v in cursor.ints(int(cursor.sizes(1)[0])))
            if dimension > 0:
                cursor.ints(int(cursor.sizes(1)[0]))
    return groups


def read_elements41(cursor: Cursor, entities: Entities) -> list[Block]:
    """Read ``$Elements`` of version 4.1."""
    blocks, count = (int(v) for v in cursor.sizes(4)[:2])
    check_count(count, "elements", cursor.place(0))
    found = []
    for _ in range(blocks):
        start = cursor.position
        dimension, entity, kind = (int(v) for v in cursor.ints(3))
        width = element_width(kind, cursor.place(start))
        rows = int(cursor.sizes(1)[0])
        first = cursor.position
        table = cursor.sizes(rows * (1 + width)).reshape(rows, 1 + width)
        lines = cursor.lines(first + (1 + width) * np.arange(rows))
        physical = entities.get((dimension, entity), ())
        found.append(Block(kind=kind, physical=physical, tags=table[:, 1:], lines=lines))
    total = sum(len(block.tags) for block in found)
    if total != count:
        raise MeshError(f"{cursor.place(0)}: {count} elements announced, {total} found")
    return found


def read_text_nodes22(cursor: Cursor) -> Nodes:
    """Read ``$Nodes`` of a version 2.2 text file."""
    count = check_count(int(cursor.sizes(1)[0]), "nodes", cursor.place(0))
    first = cursor.position
    # Four numbers a row, of which the first is a whole one: exact in a double up to 2**53.
    table = cursor.doubles(4 * count).reshape(count, 4)
    bad = ~((np.abs(table[:, 0]) < 2.0**53) & (np.trunc(table[:, 0]) == table[:, 0]))
    if bad.any():
        row = int(np.argmax(bad))
        raise MeshError(
            f"{cursor.place(first + 4 * row)}: node number {table[row, 0]}; expected a whole number"
        )
    lines = cursor.lines(first + 4 * np.arange(count))
    return Nodes(tags=table[:, 0].astype(np.int64), points=table[:, 1:], lines=lines)


def read_binary_nodes22(cursor: Cursor, count: int) -> Nodes:
    """Read ``$Nodes`` of a version 2.2 binary file, whose count stands before the bytes."""
    check_count(count, "nodes", cursor.place(cursor.position))
    # One row is an int and three doubles: seven 32-bit words.
    words = cursor.ints(7 * count).astype("<i4").reshape(count, 7)
    points = np.ascontiguousarray(words[:, 1:]).view("<f8").astype(np.float64)
    return Nodes(tags=words[:, 0].astype(np.int64), points=points, lines=None)


def read_text_elements22(cursor: Cursor) -> list[Block]:
    """Read ``$Elements`` of a version 2.2 text file; neighbours of one kind and group make a block."""
    count = check_count(int(cursor.sizes(1)[0]), "elements", cursor.place(0))
    keys, rows, starts = [], [], []
    for _ in range(count):
        start = cursor.position
        _, kind, tags = (int(v) for v in cursor.ints(3))
        width = element_width(kind, cursor.place(start))
        if tags < 0:
            raise MeshError(f"{cursor.place(start)}: element with {tags} tags; expected none or more")
        values = cursor.ints(tags + width)
        keys.append((kind, _groups22(values[:tags])))
        rows.append(values[tags:])
        starts.append(start)
    blocks = []
    begin = 0
    for end in range(1, count + 1):
        if end == count or keys[end] != keys[begin]:
            lines = cursor.lines(np.array(starts[begin:end], dtype=np.int64))
            kind, physical = keys[begin]
            blocks.append(Block(kind=kind, physical=physical, tags=np.stack(rows[begin:end]), lines=lines))
            begin = end
    return blocks


def read_binary_elements22(cursor: Cursor, count: int) -> list[Block]:
    """Read ``$Elements`` of a version 2.2 binary file, whose count stands before the bytes."""
    check_count(count, "elements", cursor.place(cursor.position))
    blocks: list[Block] = []
    found = 0
    while found < count:
        start = cursor.position
        kind, rows, tags = (int(v) for v in cursor.ints(3))
        width = element_width(kind, cursor.place(start))
        if rows < 1 or tags < 0:
            raise MeshError(f"{cursor.place(start)}: {rows} elements with {tags} tags; expected at least one")
        table = cursor.ints(rows * (1 + tags + width)).reshape(rows, -1)
        physical = table[:, 1] if tags else np.zeros(rows, dtype=np.int64)
        cuts = np.flatnonzero(np.diff(physical)) + 1
        for part in np.split(np.arange(rows), cuts):
            groups = _groups22(physical[part[:1]])
            blocks.append(Block(kind=kind, physical=groups, tags=table[part, 1 + tags :], lines=None))
        found += rows
    if found != count:
        raise MeshError(f"{cursor.place(cursor.position)}: {count} elements announced, {found} found")
    return blocks


def _groups22(tags: IntArray) -> tuple[int, ...]:
    """Return the physical group of an element: its first tag, where 0 means none."""
    return (int(abs(tags[0])),) if len(tags) and tags[0] != 0 else ()


def _join(parts: list[IntArray]) -> IntArray:
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])


def _join_lines(parts: list[IntArray | None]) -> IntArray | None:
    known = [part for part in parts if part is not None]
    return _join(known) if len(known) == len(parts) else None
