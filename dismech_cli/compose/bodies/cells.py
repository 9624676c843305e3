"""Edges and triangles of one body as places where its properties are asked for."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import FloatArray, IntArray, Numbers
from ...frozen import frozen
from ...mesh.measure import edge_lengths, triangle_areas
from ...mesh.mesh import Mesh
from ...mesh.topology.rods import ChainKind, chains

_OUT = 0.5 * np.sqrt(0.6)
_EDGE = np.array([0.0, 1.0, 0.5 - _OUT, 0.5, 0.5 + _OUT])
_EDGE_WEIGHTS = np.array([0.0, 0.0, 5.0, 8.0, 5.0]) / 18.0
_IN, _OFF = 2.0 / 3.0, 1.0 / 6.0
_TRIANGLE = np.array(
    [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [_IN, _OFF, _OFF],
        [_OFF, _IN, _OFF],
        [_OFF, _OFF, _IN],
    ]
)
_TRIANGLE_WEIGHTS = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]) / 3.0


@frozen
class Cells:
    """Points on the edges of a rod, or on the triangles of a shell.

    Attributes:
        places: Variables of place at each point of each cell, shape (P, K); s and arc on rods only that
            do not branch.
        weights: Share of each point in the mean over a cell, shape (P,): that of polynomials of degree 5
            along an edge and 2 on a triangle is exact. The ends and corners have none, so that a jump
            there is one.
        groups: Cells of each group of the mesh.
        size: Length of a rod, square root of the area of a shell [m].
        lacking: Why there is no s.
    """

    places: Mapping[str, FloatArray]
    weights: FloatArray
    groups: Mapping[str, IntArray]
    size: float
    lacking: str

    @property
    def count(self) -> int:
        """Number K of cells."""
        return len(self.places["x"][0])

    def mean(self, values: Numbers) -> FloatArray:
        """Mean over each cell of values (P, K), or of one number for all, shape (K,)."""
        values = np.asarray(values)
        return self.weights @ values if values.ndim else np.full(self.count, values)

    def in_series(self, stiffness: Numbers) -> FloatArray:
        """Stiffness of each cell whose parts act in series, as :meth:`mean`."""
        stiffness = np.asarray(stiffness)
        return 1.0 / self.mean(1.0 / stiffness) if stiffness.ndim else self.mean(stiffness)


def rod_cells(mesh: Mesh, groups: Mapping[str, IntArray]) -> Cells:
    """Points on the edges of a rod: both ends, and three of Gauss, of which the second is the middle."""
    edges, (arc, s), lacking = mesh.edges.copy(), np.zeros((2, 2, len(mesh.edges))), ""
    for chain in chains(len(mesh.nodes), mesh.edges):
        if chain.kind is ChainKind.NETWORK:
            lacking = "a rod that branches"
            break
        nodes = chain.nodes
        if chain.kind is ChainKind.CLOSED:
            nodes = np.append(nodes, nodes[0])
        edges[chain.edges] = np.column_stack((nodes[:-1], nodes[1:]))
        reached = np.concatenate(([0.0], np.cumsum(edge_lengths(mesh.nodes, mesh.edges[chain.edges]))))
        arc[:, chain.edges] = reached[:-1], reached[1:]
        s[:, chain.edges] = arc[:, chain.edges] / reached[-1]
    tail, head = (mesh.nodes[edges[:, k]].T for k in range(2))
    places = _named(_between(tail, head))
    if not lacking:
        places |= {"s": _between(*s), "arc": _between(*arc)}
    return Cells(places, _EDGE_WEIGHTS, groups, float(edge_lengths(mesh.nodes, edges).sum()), lacking)


def _between(tail: FloatArray, head: FloatArray) -> FloatArray:
    """Values at the points of edges from those at their ends (..., E), shape (..., P, E)."""
    part = _EDGE[:, None]
    return (1.0 - part) * tail[..., None, :] + part * head[..., None, :]


def shell_cells(mesh: Mesh) -> Cells:
    """Points on the triangles of a shell: the corners, and three within."""
    points = np.einsum("pk,tkc->cpt", _TRIANGLE, mesh.nodes[mesh.triangles])
    groups = {
        name: np.flatnonzero(np.isin(mesh.triangles, group).all(axis=1))
        for name, group in mesh.node_groups.items()
    }
    size = float(np.sqrt(triangle_areas(mesh.nodes, mesh.triangles).sum()))
    return Cells(_named(points), _TRIANGLE_WEIGHTS, {**groups, **mesh.triangle_groups}, size, "a shell")


def _named(points: FloatArray) -> dict[str, FloatArray]:
    """The variables of space at points (3, P, K)."""
    x, y, z = points
    return {"x": x, "y": y, "z": z, "r": np.hypot(x, y)}
