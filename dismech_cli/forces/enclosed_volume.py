"""The volume that a shell encloses, its openings closed by fans about the centroids of their rims.

A fan about its own rim's centroid moves with the shell, so the volume does not change in a rigid
motion: the bare sum over the triangles of an open shell would depend on the origin.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from ..arrays import FloatArray, IntArray, distinct
from ..frozen import frozen
from ..mesh.topology.components import components
from ..mesh.topology.sides import rim_sides


@frozen
class EnclosedVolume:
    """A closed surface made of a shell and its fans.

    Attributes:
        triangles: Corners, shape (T + K, 3): the shell's T, then one for each of K rim edges.
            Corners from N on are centroids of rims.
        corners: Corners from nodes, shape (N + rims, N): identity, then averages over rims.
        sums: Over nodes of what triangles give to their corners, shape (N, 3 (T + K)).
    """

    triangles: IntArray
    corners: csr_matrix
    sums: csr_matrix

    @classmethod
    def of(cls, n_nodes: int, triangles: IntArray) -> EnclosedVolume:
        """Close a consistently oriented shell.

        Args:
            n_nodes: Nodes of the model.
            triangles: Shape (T, 3).
        """
        rim = rim_sides(triangles)
        nodes = distinct(rim)
        label = np.full(n_nodes, -1, dtype=np.int64)
        _, parts = components(n_nodes, rim)
        rims, label[nodes] = np.unique(parts[nodes], return_inverse=True)
        # A fan triangle runs along its rim edge against the shell's own triangle.
        fans = np.stack((rim[:, 1], rim[:, 0], n_nodes + label[rim[:, 0]]), axis=1)
        sizes = np.bincount(label[nodes], minlength=len(rims))
        rows = np.concatenate((np.arange(n_nodes), n_nodes + label[nodes]))
        columns = np.concatenate((np.arange(n_nodes), nodes))
        weights = np.concatenate((np.ones(n_nodes), 1.0 / sizes[label[nodes]]))
        shape = (n_nodes + len(rims), n_nodes)
        every = np.concatenate((triangles, fans))
        corners = csr_matrix((weights, (rows, columns)), shape=shape)
        return cls(every, corners, (corners.T @ _incidence(every, shape[0])).tocsr())

    def value(self, positions: FloatArray) -> float:
        """Volume [m^3], positive where normals point outward.

        Args:
            positions: Nodes [m], shape (N, 3).
        """
        x0, x1, x2 = self.at(positions).transpose(1, 2, 0)
        return float(np.einsum("ti,ti->", x0, np.cross(x1, x2))) / 6.0

    def at(self, positions: FloatArray) -> FloatArray:
        """Components of the corners, one corner of all triangles after the other, shape (3, 3, T + K)."""
        # far from the origin products of coordinates would cancel
        x = self.corners @ (positions - positions.sum(axis=0) / len(positions))
        return np.ascontiguousarray(x.T)[:, self.triangles.T]

    def gradient(self, positions: FloatArray) -> FloatArray:
        """Derivative of the volume to each node [m^2], shape (N, 3)."""
        return self.gradient_of(self.at(positions))

    def gradient_of(self, x: FloatArray) -> FloatArray:
        """The same, of what :meth:`at` gave."""
        return self._to_nodes(_crossed(x, x) / 6.0)

    def gradient_change(self, x: FloatArray, change: FloatArray) -> FloatArray:
        """Derivative of the gradient along a change of the positions [m], shape (N, 3).

        Args:
            x: What :meth:`at` gave.
            change: Of the positions [m], shape (N, 3).
        """
        d = self.at(change)
        return self._to_nodes((_crossed(x, d) + _crossed(d, x)) / 6.0)

    def _to_nodes(self, shares: FloatArray) -> FloatArray:
        """Sums of shares (3, 3 (T + K)) of the corners, shape (N, 3)."""
        return np.asarray(self.sums @ shares.T)


def _incidence(triangles: IntArray, corners: int) -> csr_matrix:
    """Ones where a corner takes a share, in the order of the triangles, which is that of the sums."""
    of = triangles.reshape(-1)
    order = np.argsort(of, kind="stable")
    triangle, corner = np.divmod(order, 3)
    counts = np.bincount(of, minlength=corners)
    starts = np.concatenate(([0], np.cumsum(counts)))
    places = corner * len(triangles) + triangle
    return csr_matrix((np.ones(len(of)), places, starts), shape=(corners, len(of)))


def _crossed(a: FloatArray, b: FloatArray) -> FloatArray:
    """Of triangles with corners a and b: a1 x b2, a2 x b0, a0 x b1, shape (3, 3 (T + K))."""
    (x, y, z), (u, v, w) = a[:, [1, 2, 0]], b[:, [2, 0, 1]]
    return np.stack((y * w - z * v, z * u - x * w, x * v - y * u)).reshape(3, -1)
