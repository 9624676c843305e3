"""The surface of rods: a tube of flat ends along every chain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .chains import Chain


@frozen(kw_only=True)
class Tubes:
    """Rings around the nodes of all chains, one after another, then the rings of their ends.

    Attributes:
        nodes: Node in the middle of each ring, shape (R,).
        radius: Of each ring [m], shape (R,).
        first: Number of the first ring of the chain of each ring, shape (R,).
        last: Number of the last one, shape (R,).
        closed: Whether the chain of a ring is a loop, shape (R,).
        axes: Direction towards which the first vertex of a chain is turned, by ring, shape (R, 3).
        ends: Rings that have a lid, shape (L,).
        outward: -1 where a lid looks against the chain, shape (L,).
        circle: Cosine and sine of the vertices of a ring, shape (2, sides).
        faces: See :class:`.parts.Part`.
        source: See there.
        body: See there.
    """

    nodes: IntArray
    radius: FloatArray
    first: IntArray
    last: IntArray
    closed: IntArray
    axes: FloatArray
    ends: IntArray
    outward: FloatArray
    circle: FloatArray
    faces: IntArray
    source: IntArray
    body: IntArray
    color: ClassVar[None] = None
    meshed: ClassVar[bool] = False

    def place(self, t: float, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Vertices [m] and outward unit normals, shape (V, 3) each."""
        middle = positions[self.nodes]
        tangent = self._tangents(middle)
        n, b = self._turned(tangent)
        c, s = self.circle[:, :, None]
        normal = c * n[:, None] + s * b[:, None]
        rings = middle[:, None] + self.radius[:, None, None] * normal
        lids = np.repeat(tangent[self.ends] * self.outward[:, None], normal.shape[1], axis=0)
        vertices = np.concatenate((rings, rings[self.ends])).reshape(-1, 3)
        return vertices, np.concatenate((normal.reshape(-1, 3), lids))

    def _tangents(self, middle: FloatArray) -> FloatArray:
        """Unit bisectors of the edges at each ring, shape (R, 3)."""
        rings = np.arange(len(middle))
        step = unit(np.diff(middle, axis=0, append=middle[-1:]))
        # the edge before and after each ring: around a loop, else that of the end twice
        before = np.where(rings > self.first, rings - 1, np.where(self.closed, self.last - 1, rings))
        after = np.where(rings < self.last, rings, np.where(self.closed, self.first, self.last - 1))
        return unit(step[before] + step[after])

    def _turned(self, tangent: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Normals that do not twist along a chain.

        Any normal will do at each ring; the angle between it and that of the ring before, carried over, is
        summed along the chain (as the reference twist of a rod is) and turned back.
        """
        n = unit(self.axes - _dot(self.axes, tangent) * tangent)
        # where the tangent has turned into the axis, another one
        lost = np.abs(_dot(self.axes, tangent))[:, 0] > 0.9
        other = np.eye(3)[np.abs(tangent).argmin(axis=1)]
        n[lost] = unit(other - _dot(other, tangent) * tangent)[lost]
        b = np.cross(tangent, n)
        t0, t1 = tangent[:-1], tangent[1:]
        carried = n[:-1] - _dot(n[:-1], t1) / np.maximum(1.0 + _dot(t0, t1), 1e-9) * (t0 + t1)
        angle = np.arctan2(_dot(carried, b[1:])[:, 0], _dot(carried, n[1:])[:, 0])
        total = np.concatenate(([0.0], np.nan_to_num(angle).cumsum()))
        total -= total[self.first]
        c, s = np.cos(total)[:, None], np.sin(total)[:, None]
        return c * n + s * b, c * b - s * n


def unit(vectors: FloatArray) -> FloatArray:
    """Vectors of length one, shape (..., 3); zero stays zero."""
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300))


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", a, b)[:, None])


def make_tubes(chains: Sequence[Chain], rest: FloatArray, least: float, sides: int) -> Tubes:
    """Make the tubes of all chains.

    Args:
        chains: At least one.
        rest: Rest positions of all nodes [m], shape (N, 3).
        least: Least radius that is drawn [m].
        sides: Vertices of a ring.
    """
    lengths = np.array([len(chain.nodes) for chain in chains])
    start = np.cumsum(lengths) - lengths
    first, last = np.repeat(start, lengths), np.repeat(start + lengths - 1, lengths)
    rings = np.arange(lengths.sum())
    nodes = np.concatenate([chain.nodes for chain in chains])
    closed = np.repeat([chain.closed for chain in chains], lengths)
    open_chains = np.flatnonzero([not chain.closed for chain in chains])
    ends = np.stack((start[open_chains], (start + lengths - 1)[open_chains]), axis=1).reshape(-1)
    along = unit(np.array([rest[chain.nodes[1]] - rest[chain.nodes[0]] for chain in chains]))
    angle = 2.0 * np.pi * np.arange(sides) / sides
    lids = len(rings) * sides + np.arange(len(ends))[:, None] * sides
    backward = np.tile([True, False], len(open_chains))
    ringed = np.concatenate((np.repeat(rings, sides), np.repeat(ends, sides)))
    body = np.repeat([chain.body for chain in chains], lengths)
    return Tubes(
        nodes=nodes,
        radius=np.maximum(np.concatenate([chain.radius for chain in chains]), least),
        first=first,
        last=last,
        closed=closed,
        axes=np.repeat(np.eye(3)[np.abs(along).argmin(axis=1)], lengths, axis=0),
        ends=ends,
        outward=np.where(backward, -1.0, 1.0),
        circle=np.stack((np.cos(angle), np.sin(angle))),
        faces=np.concatenate((_mantle(rings[rings < last], sides), _fans(lids, backward, sides))),
        source=nodes[ringed],
        body=body[ringed],
    )


def _mantle(rings: IntArray, sides: int) -> IntArray:
    """Triangles between each of these rings and the next."""
    here = np.arange(sides)
    a = (rings[:, None] * sides + here).reshape(-1)
    b = (rings[:, None] * sides + (here + 1) % sides).reshape(-1)
    return np.concatenate((np.stack((a, b, b + sides), 1), np.stack((a, b + sides, a + sides), 1)))


def _fans(lids: IntArray, backward: IntArray, sides: int) -> IntArray:
    """Triangles of the lids, whose rings begin at these vertices."""
    k = np.arange(1, sides - 1)
    fans = np.stack(np.broadcast_arrays(lids, lids + k, lids + k + 1), axis=-1)
    fans[backward] = fans[backward][..., ::-1]
    return fans.reshape(-1, 3)
