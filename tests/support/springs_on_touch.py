"""Springs between pairs of nodes that come and go: E = k (reach - distance)^2 / 2 within reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.linearization import Coupling, Linearization, Pattern
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.touch import Touch


@dataclass(frozen=True)
class Springs:
    """The springs, whoever decides which of them are there.

    Attributes:
        dofs: Numbering.
        pairs: All pairs that may touch, shape (P, 2).
        reach: Distance at which they do [m].
        stiffness: k [N/m].
    """

    dofs: DofMap
    pairs: IntArray
    reach: float
    stiffness: float
    name: ClassVar[str] = "springs"
    velocity_dependent: ClassVar[bool] = False
    symmetric: ClassVar[bool] = True
    spreads: ClassVar[bool] = True

    @classmethod
    def among(cls, dofs: DofMap, apart: int, reach: float, stiffness: float) -> Springs:
        """Between all nodes whose numbers differ by more than ``apart``."""
        i, j = np.triu_indices(dofs.n_nodes, k=apart + 1)
        return cls(dofs, np.column_stack((i, j)), reach, stiffness)

    def vectors(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """From the first to the second node of all pairs (P, d), and the distances (P,)."""
        x = self.dofs.positions(q)
        r = x[self.pairs[:, 1]] - x[self.pairs[:, 0]]
        return r, np.sqrt((r * r).sum(axis=1))

    def clique(self, pairs: IntArray) -> IntArray:
        """DOFs of pairs, shape (K, 2 d)."""
        return self.dofs.of_nodes(pairs).reshape(len(pairs), 2 * self.dofs.dimension)

    def start(self, driver: Driver) -> ComingAndGoing:
        """As a term whose stencils change."""
        return ComingAndGoing(self)


class _Bound:
    """Springs of the pairs in ``active``, with their slots."""

    def __init__(self, springs: Springs) -> None:
        self.springs = springs
        self.name = springs.name
        self.shares = (springs.name,)
        self.steady = True
        self.active = np.empty(0, dtype=np.int64)
        self._slots = np.empty((0, 1), dtype=np.int64)

    def place(self, pattern: Pattern) -> None:
        clique = self._clique = self.springs.clique(self.springs.pairs[self.active])
        size = clique.shape[1]
        i, j = np.divmod(np.arange(size**2), size)
        upper = np.flatnonzero(i <= j)
        self._slots = pattern.symmetric_slots(clique[:, i[upper]], clique[:, j[upper]])
        self._upper = upper

    @property
    def potential(self) -> _Bound:
        return self

    def energy(self, c: Configuration) -> FloatArray:
        _, distance = self.springs.vectors(c.q)
        short = np.maximum(self.springs.reach - distance, 0.0)
        return 0.5 * self.springs.stiffness * (short * short)[None]

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        gradient, _ = self._stencils(c)
        np.add.at(r, self._clique, gradient)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        gradient, hessian = self._stencils(c)
        np.add.at(into.residual, self._clique, gradient)
        np.add.at(
            into.stiffness, self._slots, hessian.reshape(len(hessian), hessian.shape[1] ** 2)[:, self._upper]
        )

    def _stencils(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """Gradients (K, 2 d) and Hessians (K, 2 d, 2 d) of the active springs."""
        s = self.springs
        r, distance = (x[self.active] for x in s.vectors(c.q))
        inside = (distance < s.reach)[:, None, None]
        n = r / distance[:, None]
        short = np.maximum(s.reach - distance, 0.0)
        along = n[:, :, None] * n[:, None, :]
        block = s.stiffness * (
            inside * along - (short / distance)[:, None, None] * (np.eye(r.shape[1]) - along)
        )
        gradient = s.stiffness * short[:, None] * np.concatenate((n, -n), axis=1)
        return gradient, np.block([[block, -block], [-block, block]])


class ComingAndGoing(_Bound):
    """Only the springs within reach are there; counts how often that changed."""

    changes = 0
    symmetric = True

    @property
    def terms(self) -> tuple[ComingAndGoing, ...]:
        return (self,)

    def add_convex_linearization(self, c: Configuration, into: Linearization) -> None:
        self.add_linearization(c, into)

    def heat(self, c: Configuration, v: FloatArray) -> float:
        return 0.0

    def recall(self, memory: Mapping[str, FloatArray]) -> None:
        pass

    def begin(self, start: Configuration, dt: float) -> None:
        pass

    def reverses(self, start: Configuration, end: Configuration) -> bool:
        return False

    def settle(self, end: Configuration) -> bool:
        return True

    def take_back(self) -> None:
        raise AssertionError("every step stands")

    def put_in(self, start: Configuration) -> float:
        return 0.0

    def memory(self) -> Mapping[str, FloatArray]:
        return {}

    def touch(self, c: Configuration) -> Touch:
        none = np.empty(0)
        return Touch((), none.astype(np.int64), *(none for _ in range(6)))

    def detect(self, c: Configuration) -> bool:
        _, distance = self.springs.vectors(c.q)
        active = np.flatnonzero(distance < self.springs.reach)
        changed = not np.array_equal(active, self.active)
        self.active = active
        self.changes += changed
        return changed

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        return (Coupling(self.springs.clique(self.springs.pairs[self.active])),)

    def longest_step(self, start: Configuration, end: Configuration) -> float:
        return 1.0


@dataclass(frozen=True)
class AlwaysThere:
    """The same springs as a term whose pattern has all pairs from the start."""

    springs: Springs
    name: ClassVar[str] = "springs"
    velocity_dependent: ClassVar[bool] = False

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        return (Coupling(self.springs.clique(self.springs.pairs)),)

    def bind(self, pattern: Pattern, driver: Driver) -> _Bound:
        bound = _Bound(self.springs)
        bound.active = np.arange(len(self.springs.pairs))
        bound.place(pattern)
        return bound
