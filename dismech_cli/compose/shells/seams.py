"""Edges of shells that are welded: they turn as one, and each sheet bends on its own side.

The sheets at a welded edge are springs that meet at a rigid joint without mass. With normals of their own,
the edges share the angle of the joint. Without, the joint is eliminated: half hinges of stiffness k_i
against it leave hinges of stiffness k_i k_j / sum(k) between all pairs of sheets, which for two is their
series. If half hinges damp with relaxation times tau_i, and the joint is where elasticity has it, these
hinges dissipate what the halves do with times tau_i + tau_j - sum(k tau) / sum(k): for two that is the mean
of the times by their turns; of a pair that damps less than the mean of three it may be negative, but what all
of them dissipate never is.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen
from ...mesh.measure import edge_lengths, triangle_areas
from ...mesh.topology.components import components
from ...mesh.topology.shells import ShellTopology
from ..bodies.geometry import Geometry
from .bending import bending_of
from .hinges import hinges_of


@frozen
class SeamHinges:
    """Hinges between triangles that no shell has as neighbours.

    Attributes:
        hinges: Nodes (x0, x1, x2, x3), shape (P, 4): shared edge x0 -> x1, x2 and x3 opposite it.
        stiffness: Shape (P,) [N m].
        faces: Their triangles, shape (P, 2).
        times: Relaxation times, shape (P,) [s].
        shares: Part of the stiffness of the hinges of each shell that is left beside them, shape (H,) each.
        own_times: Relaxation times of the hinges of each shell [s], shape (H,) each.
    """

    hinges: IntArray
    stiffness: FloatArray
    faces: IntArray
    times: FloatArray
    shares: tuple[FloatArray, ...]
    own_times: tuple[FloatArray, ...]


def welded_edges(geometry: Geometry, shells: Sequence[ShellTopology]) -> tuple[IntArray, ...]:
    """Number of the weld of each edge of each shell, shape (B,) each; -1 where nothing is welded."""
    counts = [len(one.edges) for one in shells]
    edges = np.concatenate([np.empty((0, 2), dtype=np.int64), *(one.edges for one in shells)])
    owner = np.repeat(np.arange(len(shells)), counts)
    keys = _keys(edges, len(geometry.nodes))
    links = [np.empty((0, 2), dtype=np.int64)]
    for seam in geometry.seams:
        inside = np.isin(owner, seam.shells) & np.isin(keys, _keys(seam.sides, len(geometry.nodes)))
        links.append(_chained(keys, np.flatnonzero(inside)))
    for number, shell in enumerate(geometry.shells):
        if shell.mesh is not None and shell.mesh.branches == "weld":
            links.append(_chained(keys, np.flatnonzero(owner == number)))
    joined = np.concatenate(links)
    weld = np.full(len(edges), -1)
    members, ends = np.unique(joined, return_inverse=True)
    if members.size:
        _, weld[members] = components(len(members), ends.reshape(-1, 2))
    return _parted(weld, counts)


def _parted(values: NDArray[Any], counts: Sequence[int]) -> tuple[NDArray[Any], ...]:
    """Values of all shells, shell by shell."""
    ends = np.cumsum([0, *counts])
    return tuple(values[start:end] for start, end in pairwise(ends))


def _keys(edges: IntArray, count: int) -> IntArray:
    """One number for the two nodes of each edge."""
    keys: IntArray = edges.min(axis=1) * count + edges.max(axis=1)
    return keys


def _chained(keys: IntArray, members: IntArray) -> IntArray:
    """Each member with the next of its key, shape (links, 2)."""
    order = members[np.argsort(keys[members], kind="stable")]
    same = keys[order[1:]] == keys[order[:-1]]
    return np.stack((order[:-1][same], order[1:][same]), axis=1)


def turned_edges(shells: Sequence[ShellTopology], welds: Sequence[IntArray]) -> tuple[BoolArray, ...]:
    """True for edges of each shell that run against the first one of their weld, shape (B,) each."""
    edges = np.concatenate([np.empty((0, 2), dtype=np.int64), *(one.edges for one in shells)])
    weld = np.concatenate([np.empty(0, dtype=np.int64), *welds])
    chosen = np.flatnonzero(weld >= 0)
    numbers, first = np.unique(weld[chosen], return_index=True)
    lead = np.zeros((len(numbers), 2), dtype=np.int64)
    lead[numbers] = edges[chosen[first]]
    against = np.zeros(len(edges), dtype=np.bool_)
    against[chosen] = edges[chosen, 0] != lead[weld[chosen], 0]
    return _parted(against, [len(one.edges) for one in shells])


def shared_normals(welds: IntArray) -> IntArray:
    """Numbers of the normals of edges, one for all of a weld, counted as they come, shape (B,).

    Args:
        welds: Weld of each edge that carries a normal, -1 for none, shape (B,).
    """
    key = np.where(welds < 0, np.arange(len(welds)), len(welds) + welds)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    number = np.empty(len(first), dtype=np.int64)
    number[np.argsort(first)] = np.arange(len(first))
    numbers: IntArray = number[inverse]
    return numbers


def seam_hinges(geometry: Geometry, shells: Sequence[ShellTopology], welds: Sequence[IntArray]) -> SeamHinges:
    """Hinges between the sheets of welds whose edges have no normals."""
    shares = [np.ones(len(one.hinges)) for one in shells]
    own_times = [
        np.full(len(one.hinges), sheet.relaxation_time)
        for one, sheet in zip(shells, geometry.sheets, strict=True)
    ]
    sides: dict[int, list[_Side]] = {}
    for number, (topology, weld) in enumerate(zip(shells, welds, strict=True)):
        if bending_of(geometry.shells[number]).at_hinges:
            for side in _sides(geometry, number, topology, weld):
                sides.setdefault(side.weld, []).append(side)
    hinges, stiffness, times, faces = [], [], [], []
    for members in sides.values():
        total = sum(side.stiffness for side in members)
        mean = sum(side.stiffness * side.time for side in members) / total
        for one, two in combinations(members, 2):
            time = one.time + two.time - mean
            if (one.shell, one.edge) == (two.shell, two.edge):
                own = shells[one.shell].hinge_edges == one.edge
                shares[one.shell][own] = (one.stiffness + two.stiffness) / total
                own_times[one.shell][own] = time
                continue
            a, b = shells[members[0].shell].edges[members[0].edge]
            hinges.append((a, b, one.opposite, two.opposite))
            stiffness.append(one.stiffness * two.stiffness / total)
            times.append(time)
            faces.append((one.face, two.face))
    return SeamHinges(
        np.array(hinges, dtype=np.int64).reshape(-1, 4),
        np.array(stiffness, dtype=np.float64),
        np.array(faces, dtype=np.int64).reshape(-1, 2),
        np.array(times, dtype=np.float64),
        tuple(shares),
        tuple(own_times),
    )


@frozen
class _Side:
    """A triangle at a welded edge.

    Attributes:
        weld: Number of the weld.
        shell: Number of its shell.
        edge: Number of the edge within the shell.
        face: The triangle among those of the scene.
        opposite: Its node opposite the edge.
        stiffness: Of its half of a hinge [N m].
        time: Relaxation time of the shell [s].
    """

    weld: int
    shell: int
    edge: int
    face: int
    opposite: int
    stiffness: float
    time: float


def _sides(geometry: Geometry, number: int, topology: ShellTopology, weld: IntArray) -> list[_Side]:
    """The triangles of a shell at its welded edges."""
    own = np.flatnonzero(geometry.triangle_shell == number)
    edges, slot = np.nonzero((weld >= 0)[:, None] & (topology.edge_faces >= 0))
    inside, sheet = topology.edge_faces[edges, slot], geometry.sheets[number]
    faces = own[inside]
    triangles = geometry.triangles[faces]
    opposite = triangles.sum(axis=1) - topology.edges[edges].sum(axis=1)
    stiffness = hinges_of(geometry.shells[number]).half(
        sheet.youngs_modulus[inside],
        sheet.thickness[inside],
        edge_lengths(geometry.nodes, topology.edges[edges]),
        triangle_areas(geometry.nodes, triangles),
    )
    return [
        _Side(int(weld[e]), number, int(e), int(f), int(o), float(k), sheet.relaxation_time)
        for e, f, o, k in zip(edges, faces, opposite, stiffness, strict=True)
    ]
