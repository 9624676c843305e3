"""How far a state is from what the models of its bodies mean, element by element."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...mesh.measure import area_vectors, edge_lengths, triangle_areas
from .corners import CornerStrains
from .snapshot import Snapshot


@frozen
class MembraneStrain:
    """Largest change of length of each triangle in any direction, of its rest length.

    Attributes:
        triangles: Shape (T, 3).
        metric: Rest metric A11, A22, A12 [m^2], shape (3, T).
    """

    triangles: IntArray
    metric: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (T,)."""
        a11, a22, a12 = self.metric
        x = s.positions[self.triangles]
        u, v = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
        m11, m22, m12 = (np.einsum("ti,ti->t", *pair) for pair in ((u, u), (v, v), (u, v)))
        square = a11 * a22 - a12 * a12
        half = 0.5 * (a22 * m11 + a11 * m22 - 2.0 * a12 * m12) / square
        apart = np.sqrt(np.maximum(half * half - (m11 * m22 - m12 * m12) / square, 0.0))
        longer, shorter = np.sqrt(half + apart), np.sqrt(np.maximum(half - apart, 0.0))
        return np.asarray(np.maximum(longer - 1.0, 1.0 - shorter))


@frozen
class LostArea:
    """Part of its rest area that each triangle has lost.

    Attributes:
        triangles: Shape (T, 3).
        rest: Rest areas [m^2], shape (T,).
    """

    triangles: IntArray
    rest: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (T,)."""
        return np.asarray(1.0 - triangle_areas(s.positions, self.triangles) / self.rest)


@frozen
class Fold:
    """Angle by which neighbouring triangles are folded more than at rest [rad].

    Attributes:
        triangles: Shape (T, 3).
        pairs: Neighbours, shape (H, 2).
        rest: At rest [rad], shape (H,).
    """

    triangles: IntArray
    pairs: IntArray
    rest: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (H,)."""
        return folds(s.positions, self.triangles, self.pairs) - self.rest


def folds(positions: FloatArray, triangles: IntArray, pairs: IntArray) -> FloatArray:
    """Angle between the normals of neighbouring triangles [rad], shape (H,)."""
    normal = area_vectors(positions, triangles)
    return _between(normal[pairs[:, 0]], normal[pairs[:, 1]])


@frozen
class RodStrain:
    """Change of length of each edge from its natural length, of the longer of that and the rest length.

    A muscle may be told to be next to nothing long, or less: of that any length would be any strain.

    Attributes:
        edges: Shape (K, 2).
        rest: Rest lengths [m], shape (K,).
        energy: Name of the stretching energy.
        stencils: Places of the edges in it, shape (K,).
    """

    edges: IntArray
    rest: FloatArray
    energy: str
    stencils: IntArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (K,)."""
        natural = s.natural(self.energy)[0, self.stencils]
        change = edge_lengths(s.positions, self.edges) - self.rest * (1.0 + natural)
        return np.asarray(np.abs(change) / (self.rest * np.maximum(1.0 + natural, 1.0)))


@frozen
class RodTurn:
    """Angle by which each joint of rods turns more than at rest [rad].

    Attributes:
        triples: Nodes of the joints, shape (J, 3).
        rest: At rest [rad], shape (J,).
    """

    triples: IntArray
    rest: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (J,)."""
        return turns(s.positions, self.triples) - self.rest


@frozen
class RodBend:
    """Curvature of each joint of rods beyond that at rest, times the radius.

    Attributes:
        triples: Nodes of the joints, shape (J, 3).
        slenderness: Radius over the length on which it bends, shape (J,).
        rest: 2 tan(turn / 2) at rest, shape (J,).
    """

    triples: IntArray
    slenderness: FloatArray
    rest: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (J,)."""
        return self.slenderness * (2.0 * np.tan(0.5 * turns(s.positions, self.triples)) - self.rest)

    def turns_to(self, value: float) -> FloatArray:
        """Angle by which each joint turns at a value [rad], shape (J,)."""
        return np.asarray(2.0 * np.arctan2(value + self.slenderness * self.rest, 2.0 * self.slenderness))


@frozen
class CornerTurn:
    """Angle by which the edges at each corner, or at each edge of a hub, turn more than at rest [rad].

    Attributes:
        corners: The corners.
        voronoi: Length over which each bends [m], shape (K,).
    """

    corners: CornerStrains
    voronoi: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (K,)."""
        return np.asarray(2.0 * np.arctan(0.5 * self.voronoi * self.corners.curvature(s)))


@frozen
class CornerBend:
    """Curvature by which each corner has bent from rest, times the radius.

    Attributes:
        corners: The corners.
        radius: Of the thicker edge [m], shape (K,).
    """

    corners: CornerStrains
    radius: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (K,)."""
        return np.asarray(self.radius * self.corners.curvature(s))


def turns(positions: FloatArray, triples: IntArray) -> FloatArray:
    """Angle between the two edges of each joint [rad], shape (J,)."""
    a, b, c = (positions[triples[:, k]] for k in range(3))
    return _between(b - a, c - b)


def _between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Angles of vectors [rad], right to 1e-8: shape (K,) of (K, 3); none where one has no length."""
    size = np.sqrt(np.einsum("ki,ki->k", a, a) * np.einsum("ki,ki->k", b, b))
    cosine = np.einsum("ki,ki->k", a, b) / np.where(size > 0.0, size, np.inf)
    return np.where(size > 0.0, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0)
