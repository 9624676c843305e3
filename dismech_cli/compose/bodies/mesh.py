"""The mesh of one body, and which nodes of its file it took."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path

import numpy as np

from ...arrays import IntArray, distinct
from ...frozen import frozen
from ...mesh.mesh import Mesh
from .placement import Placement


def _no_numbers() -> IntArray:
    return np.empty(0, dtype=np.int64)


@frozen
class BodyMesh:
    """A mesh of rod edges or of triangles.

    Attributes:
        mesh: The mesh; every node belongs to an element.
        file: File that it was read from, or None.
        numbers: Number of each node in that file, shape (N,): nodes that two bodies take from one
            file are the same place.
        lines_left: Lines of the file that the body does not take.
        triangles_left: Triangles of the file that it does not take.
    """

    mesh: Mesh
    file: Path | None = None
    numbers: IntArray = field(default_factory=_no_numbers)
    lines_left: frozenset[int] = frozenset()
    triangles_left: frozenset[int] = frozenset()


def part_of_file(
    mesh: Mesh, path: Path, place_nodes: Placement, edges: IntArray, triangles: IntArray
) -> BodyMesh:
    """Some edges and triangles of a file, with the nodes that they use.

    Groups of nodes, edges and triangles are kept as far as they lie within; a group of triangles is
    a group of nodes too.

    Args:
        mesh: All that the file holds.
        path: The file.
        place_nodes: Where its nodes go.
        edges: Indices of the wanted edges.
        triangles: Indices of the wanted triangles.
    """
    used = distinct(np.concatenate((mesh.edges[edges].reshape(-1), mesh.triangles[triangles].reshape(-1))))
    place = np.full(len(mesh.nodes), -1)
    place[used] = np.arange(len(used))
    node_groups = {name: place[group] for name, group in mesh.node_groups.items()}
    for name, group in mesh.triangle_groups.items():
        if len(triangles):
            node_groups.setdefault(name, place[distinct(mesh.triangles[group])])
    part = Mesh(
        nodes=place_nodes(mesh.nodes[used]),
        edges=place[mesh.edges[edges]],
        triangles=place[mesh.triangles[triangles]],
        node_groups={name: group[group >= 0] for name, group in node_groups.items() if (group >= 0).any()},
        edge_groups=_within(mesh.edge_groups, edges, len(mesh.edges)),
        triangle_groups=_within(mesh.triangle_groups, triangles, len(mesh.triangles)),
        notes=mesh.notes,
    )
    return BodyMesh(
        part,
        path.resolve(),
        used,
        frozenset(np.delete(np.arange(len(mesh.edges)), edges).tolist()),
        frozenset(np.delete(np.arange(len(mesh.triangles)), triangles).tolist()),
    )


def left_out(bodies: Iterable[BodyMesh]) -> Iterator[str]:
    """What each file holds that no body takes, a sentence a file."""
    files: dict[Path, list[BodyMesh]] = {}
    for body in bodies:
        if body.file is not None:
            files.setdefault(body.file, []).append(body)
    for file, takers in files.items():
        lines = len(frozenset.intersection(*(body.lines_left for body in takers)))
        triangles = len(frozenset.intersection(*(body.triangles_left for body in takers)))
        told = [f"{n} {what}" for n, what in ((lines, "lines"), (triangles, "triangles")) if n]
        if told:
            yield f"{file.name}: {' and '.join(told)} are in no body; lines make rods, triangles shells."


def _within(groups: Mapping[str, IntArray], chosen: IntArray, count: int) -> dict[str, IntArray]:
    place = np.full(count, -1)
    place[chosen] = np.arange(len(chosen))
    kept = {name: place[group][place[group] >= 0] for name, group in groups.items()}
    return {name: group for name, group in kept.items() if group.size}
