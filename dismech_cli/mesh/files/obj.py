"""Wavefront OBJ: faces become shell triangles, ``l`` polylines become rod edges."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...arrays import FloatArray
from ...errors import MeshError
from ..allowed import PLAIN, Allowed
from ..limits import check_count
from ..mesh import Mesh
from ..validate import Lines, validate
from .groups import GroupBuilder
from .polygon import MAX_CORNERS, triangulate
from .source import in_space, load_text, parse_float, parse_int

# Keywords that carry appearance only; dropping them cannot change the mechanics.
_APPEARANCE = frozenset(
    (
        *("vt", "vn", "vp", "s", "mg", "lod", "mtllib", "usemap", "maplib", "bevel"),
        *("c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech", "stech"),
    )
)

_NAMING = (["g"], ["o"], ["usemtl"])
_LOOSE_HASH = re.compile(r"(?<!\S)#(?=\s|$)")


@dataclass(slots=True)
class _Parsed:
    """What the lines of a file say, before indices are checked; grows while reading."""

    nodes: list[list[float]] = field(default_factory=list)
    node_lines: list[int] = field(default_factory=list)
    edges: list[tuple[int, int]] = field(default_factory=list)
    edge_lines: list[int] = field(default_factory=list)
    faces: list[list[int]] = field(default_factory=list)
    face_lines: list[int] = field(default_factory=list)
    face_groups: list[tuple[str, ...]] = field(default_factory=list)
    node_members: GroupBuilder = field(default_factory=GroupBuilder)
    edge_members: GroupBuilder = field(default_factory=GroupBuilder)
    group: tuple[str, ...] = ()
    body: tuple[str, ...] = ()
    material: tuple[str, ...] = ()

    def names(self) -> tuple[str, ...]:
        """Return the groups that the next element belongs to."""
        return tuple(dict.fromkeys(self.group + self.body + self.material))


def read_obj(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read a Wavefront OBJ mesh.

    ``f`` (v, v/vt, v//vn, v/vt/vn, negative numbers too) gives triangles, polygons are cut;
    ``l`` gives rod edges; ``g``, ``o`` and ``usemtl`` name groups of triangles, edges and nodes;
    ``p`` adds nodes to the groups.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_obj(load_text(path), str(path), allowed)


def parse_obj(text: str, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the text of an OBJ file; ``where`` names it in messages.

    Raises:
        MeshError: If the text is malformed or describes an unusable mesh.
    """
    parsed = _Parsed()
    for number, line in _logical_lines(text):
        keyword, *tokens = line.split()
        _parse_line(parsed, keyword, tokens, number, f"{where}:{number}")
    return _assemble(parsed, where, allowed)


def _logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Yield (first line number, content) with comments removed and continued lines joined."""
    pending, first = "", 0
    for number, line in enumerate(text.split("\n"), start=1):
        content = _without_comment(line).rstrip()
        first = first or number
        if content.endswith("\\"):
            pending += content[:-1] + " "
            continue
        if (pending + content).strip():
            yield first, pending + content
        pending, first = "", 0
    if pending.strip():
        yield first, pending


def _without_comment(line: str) -> str:
    """A hash begins a comment; within a name, as in ``usemtl Material #1``, only with a blank after it."""
    if line.split(None, 1)[:1] in _NAMING:
        return _LOOSE_HASH.split(line, maxsplit=1)[0]
    return line.partition("#")[0]


def _parse_line(parsed: _Parsed, keyword: str, tokens: list[str], number: int, place: str) -> None:
    match keyword:
        case "v":
            # After x y z come a weight or a colour, or both.
            if len(tokens) not in (2, 3, 4, 6, 7):
                raise MeshError(f"{place}: vertex with {len(tokens)} numbers; expected x y z")
            parsed.nodes.append([parse_float(token, place) for token in tokens[:3]])
            parsed.node_lines.append(number)
        case "f":
            face = _node_indices(tokens, len(parsed.nodes), place)
            if not 3 <= len(face) <= MAX_CORNERS:
                raise MeshError(f"{place}: face with {len(face)} corners; expected 3 to {MAX_CORNERS}")
            parsed.faces.append(face)
            parsed.face_lines.append(number)
            parsed.face_groups.append(parsed.names())
        case "l":
            chain = _node_indices(tokens, len(parsed.nodes), place)
            if len(chain) < 2:
                raise MeshError(f"{place}: line with {len(chain)} nodes; expected at least 2")
            start = len(parsed.edges)
            parsed.edges += pairwise(chain)
            parsed.edge_lines += [number] * (len(chain) - 1)
            parsed.edge_members.add(parsed.names(), range(start, len(parsed.edges)))
            parsed.node_members.add(parsed.names(), chain)
        case "p":
            parsed.node_members.add(parsed.names(), _node_indices(tokens, len(parsed.nodes), place))
        case "g":
            parsed.group = tuple(tokens)
        case "o":
            parsed.body = (" ".join(tokens),) if tokens else ()
        case "usemtl":
            parsed.material = (" ".join(tokens),) if tokens else ()
        case _ if keyword not in _APPEARANCE:
            raise MeshError(f"{place}: keyword {keyword[:40]!r}; expected v, vt, vn, f, l, p, g, o or usemtl")
        case _:
            pass


def _node_indices(tokens: list[str], known: int, place: str) -> list[int]:
    """Convert references v, v/vt, v//vn or v/vt/vn to indices from 0.

    A number below zero counts back from the latest vertex; zero means nothing.
    """
    indices = []
    for token in tokens:
        number = parse_int(token.split("/", 1)[0], place)
        if number == 0 or number < -known:
            raise MeshError(f"{place}: vertex number {number}; {known} vertices precede this line")
        indices.append(number - 1 if number > 0 else known + number)
    return indices


def _assemble(parsed: _Parsed, where: str, allowed: Allowed) -> Mesh:
    count = check_count(len(parsed.nodes), "nodes", where)
    nodes, notes = in_space(parsed.nodes, parsed.node_lines, where)
    triangles: list[tuple[int, int, int]] = []
    triangle_lines: list[int] = []
    triangle_members = GroupBuilder()
    cut = {"quad": 0, "polygon": 0}
    for face, line, names in zip(parsed.faces, parsed.face_lines, parsed.face_groups, strict=True):
        # Vertices may follow the faces that use them, so the range is known only now.
        if max(face) >= count:
            raise MeshError(f"{where}:{line}: vertex number {max(face) + 1}; the file has {count} vertices")
        pieces = _cut(face, nodes)
        if len(pieces) > 1:
            cut["quad" if len(pieces) == 2 else "polygon"] += 1
        triangle_members.add(names, range(len(triangles), len(triangles) + len(pieces)))
        parsed.node_members.add(names, face)
        triangles += pieces
        triangle_lines += [line] * len(pieces)
    node_groups = parsed.node_members.build()
    mesh = Mesh(
        nodes=nodes,
        edges=np.array(parsed.edges, dtype=np.int64).reshape(-1, 2),
        triangles=np.array(triangles, dtype=np.int64).reshape(-1, 3),
        node_groups={name: group[group < count] for name, group in node_groups.items()},
        edge_groups=parsed.edge_members.build(),
        triangle_groups=triangle_members.build(),
        notes=(*notes, *(f"{n} {name}s split into triangles." for name, n in cut.items() if n)),
    )
    lines = Lines(
        nodes=np.array(parsed.node_lines, dtype=np.int64),
        edges=np.array(parsed.edge_lines, dtype=np.int64),
        triangles=np.array(triangle_lines, dtype=np.int64),
    )
    return validate(mesh, where, lines, allowed)


def _cut(face: list[int], nodes: FloatArray) -> list[tuple[int, int, int]]:
    if len(face) == 3:
        return [(face[0], face[1], face[2])]
    return [(face[a], face[b], face[c]) for a, b, c in triangulate(nodes[face])]
