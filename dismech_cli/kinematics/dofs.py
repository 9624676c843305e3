"""Numbering of the degrees of freedom: q = [node positions | edge angles | mid-edge normals]."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen

AXES = {"x": 0, "y": 1, "z": 2}


@frozen
class DofMap:
    """Maps nodes and edges to DOFs, and back to words.

    Attributes:
        n_nodes: Nodes with position DOFs, the walls behind clamps and the frames of joints included.
        n_angles: Edges that carry an angle theta; 0 unless rods are framed.
        axes: Space axes that the model carries: (0, 1, 2), or the two of the plane.
        visible: Nodes that the user knows of; those of walls and of joints come after them.
        hidden: Coordinate of all nodes normal to the plane of a planar scene [m].
        n_normals: Shell edges whose normal is free: each carries an angle xi.
    """

    n_nodes: int
    n_angles: int
    axes: tuple[int, ...]
    visible: int
    hidden: float = 0.0
    n_normals: int = 0

    @property
    def dimension(self) -> int:
        """Position DOFs per node."""
        return len(self.axes)

    @property
    def n_positions(self) -> int:
        """Position DOFs in all."""
        return self.n_nodes * len(self.axes)

    @property
    def n(self) -> int:
        """DOFs in all."""
        return self.n_positions + self.n_angles + self.n_normals

    @property
    def _columns(self) -> slice:
        """The axes as columns of a space array: a slice is written many times faster than a list."""
        return slice(self.axes[0], self.axes[-1] + 1, self.axes[1] - self.axes[0])

    def of_nodes(self, nodes: IntArray) -> IntArray:
        """DOFs of nodes, shape (*nodes.shape, dimension)."""
        return np.asarray(nodes)[..., None] * self.dimension + np.arange(self.dimension)

    def of_angles(self, edges: IntArray) -> IntArray:
        """DOFs of the angles of edges."""
        return self.n_positions + np.asarray(edges)

    def of_normals(self, edges: IntArray) -> IntArray:
        """DOFs of the mid-edge normals of shell edges."""
        return self.n_positions + self.n_angles + np.asarray(edges)

    def positions(self, q: FloatArray) -> FloatArray:
        """Node part of ``q`` as an array of shape (n_nodes, dimension); a view."""
        return q[: self.n_positions].reshape(self.n_nodes, self.dimension)

    def space_positions(self, q: FloatArray) -> FloatArray:
        """Node positions in space [m], shape (n_nodes, 3)."""
        out = np.empty((self.n_nodes, 3))
        out[:] = self.hidden
        out[:, self._columns] = self.positions(q)
        return out

    def embed(self, values: FloatArray) -> FloatArray:
        """Turn nodal vectors of shape (k, dimension) into space vectors (k, 3)."""
        out = np.zeros((len(values), 3))
        out[:, self._columns] = values
        return out

    def project(self, vectors: FloatArray) -> FloatArray:
        """Turn space vectors of shape (..., 3) into model vectors (..., dimension)."""
        return np.ascontiguousarray(np.asarray(vectors, dtype=np.float64)[..., list(self.axes)])

    def describe(self, dof: int) -> str:
        """Name of a DOF in the user's words."""
        if dof >= self.n_positions + self.n_angles:
            return f"mid-edge normal of shell edge {dof - self.n_positions - self.n_angles}"
        if dof >= self.n_positions:
            return f"twist angle of edge {dof - self.n_positions}"
        node, component = divmod(dof, self.dimension)
        where = f"node {node}" if node < self.visible else "the wall of a clamp or the frame of a joint"
        return f"{'xyz'[self.axes[component]]} of {where}"
