"""Sums over points of contact, to the nodes of the model."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen
from ...kernels.linearization import Coupling, Pattern
from ...kinematics.dofs import DofMap
from ..points.points import Points

# So many items are summed together: what fits in the fast memory of a core.
_TOGETHER = 256


@frozen
class Stencils:
    """Nodes of the items of one kind, and where their sums go.

    Attributes:
        map: Numbering of the DOFs.
        nodes: Nodes of each item, shape (S, n).
        squares: Whether their stiffness is along gaps alone and comes from tables of pieces, where there are
            any: blocks of pairs of nodes are symmetric then.
        dofs: Their DOFs, shape (S, n d).
        axes: The d axes that the model has.
    """

    map: DofMap
    nodes: IntArray
    squares: bool = False
    dofs: IntArray = field(init=False, repr=False, compare=False)
    axes: IntArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        count, n = self.nodes.shape
        object.__setattr__(self, "dofs", self.map.of_nodes(self.nodes).reshape(count, n * self.map.dimension))
        object.__setattr__(self, "axes", np.array(self.map.axes))

    @property
    def coupling(self) -> Coupling:
        """One clique per item."""
        return Coupling(self.dofs)

    def relative(self, points: Points, values: FloatArray) -> FloatArray:
        """Nodal vectors (N, 3) as those of the lines against what they face at points, shape (3, K)."""
        nodal = np.ascontiguousarray(values[self.nodes[points.item]].transpose(1, 2, 0))
        out: FloatArray = (points.weights[:, None] * nodal).sum(axis=0)
        return out

    def add(self, item: IntArray, vectors: FloatArray, r: FloatArray) -> None:
        """Add vectors (n, 3, K) of points of some items to the DOFs of ``r``, shape (n,)."""
        np.add.at(r, self.dofs[item], self.flat(vectors))

    def flat(self, vectors: FloatArray) -> FloatArray:
        """Vectors (n, 3, K) as those of the DOFs of an item, shape (K, n d)."""
        inside = vectors[:, list(self.map.axes)]
        n, d, count = inside.shape
        return np.ascontiguousarray(inside.reshape(n * d, count).T)

    def local(self, blocks: FloatArray) -> FloatArray:
        """Blocks (n, n, 3, 3, K) as matrices of the DOFs of an item, shape (K, n d, n d)."""
        axes = list(self.map.axes)
        inside = blocks if len(axes) == 3 else blocks[:, :, axes][:, :, :, axes]
        n, _, d, _, count = inside.shape
        matrices: FloatArray = inside.transpose(4, 0, 2, 1, 3).reshape(count, n * d, n * d)
        return matrices


@frozen
class SymmetricPlaces:
    """Slots of the upper triangles of items, shape (S, n d (n d + 1) / 2)."""

    slots: IntArray
    rows: IntArray
    columns: IntArray

    @classmethod
    def of(cls, stencils: Stencils, pattern: Pattern) -> SymmetricPlaces:
        """Look them up."""
        dofs = stencils.dofs
        i, j = np.triu_indices(dofs.shape[1])
        return cls(pattern.symmetric_slots(dofs[:, i], dofs[:, j]), i, j)

    def add(self, item: IntArray, matrices: FloatArray, values: FloatArray) -> None:
        """Add matrices (K, n d, n d) of points of some items to stored values (slots,)."""
        np.add.at(values, self.slots[item], matrices[:, self.rows, self.columns])

    def add_squares(
        self, item: IntArray, factors: FloatArray, vectors: FloatArray, values: FloatArray
    ) -> None:
        """Add factors (K,) times u u^T of vectors (K, n d) of points of some items to stored values."""
        if not len(item):
            return
        order = np.argsort(item, kind="stable")
        first = np.flatnonzero(np.diff(item[order], prepend=-1))
        # points of an item are summed before they are added, few items at a time
        for begin in range(0, len(first), _TOGETHER):
            starts = first[begin : begin + _TOGETHER]
            end = first[begin + _TOGETHER] if begin + _TOGETHER < len(first) else len(order)
            some = order[starts[0] : end]
            u = vectors[some]
            upper = (factors[some, None] * u)[:, self.rows] * u[:, self.columns]
            sums = np.add.reduceat(upper, starts - starts[0], axis=0)
            np.add.at(values, self.slots[item[order[starts]]], sums)


@frozen
class BlockPlaces:
    """Slots of the blocks of items; see :func:`.slot_loops.find_blocks`.

    Attributes:
        slots: At which rows of blocks begin, shape (S, n (n + 1) / 2 d).
        flipped: Whether the transpose is stored, shape (S, n (n + 1) / 2).
        odd: Number of each item among those whose rows have gaps, or -1, shape (S,).
        entries: Slots of the upper triangles of these, shape (O, n d (n d + 1) / 2).
    """

    slots: IntArray
    flipped: BoolArray
    odd: IntArray
    entries: IntArray


@frozen
class GeneralPlaces:
    """Slots of whole matrices of items, shape (S, (n d)^2)."""

    slots: IntArray

    @classmethod
    def of(cls, stencils: Stencils, pattern: Pattern) -> GeneralPlaces:
        """Look them up."""
        dofs = stencils.dofs
        i, j = np.divmod(np.arange(dofs.shape[1] ** 2), dofs.shape[1])
        return cls(pattern.slots_of(dofs[:, i], dofs[:, j]))

    def add(self, item: IntArray, matrices: FloatArray, values: FloatArray) -> None:
        """Add matrices (K, n d, n d) of points of some items to stored values (slots,)."""
        np.add.at(values, self.slots[item], matrices.reshape(len(matrices), self.slots.shape[1]))
