"""Loads that tie a few DOFs each by a full, unsymmetric tangent: what they share once bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.linearization import Linearization, Pattern
from .configuration import Configuration


@dataclass(frozen=True, slots=True)
class BoundCliques:
    """A load on cliques of DOFs, bound to a pattern.

    Attributes:
        name: Unique name.
        dofs: DOFs of each clique, shape (K, D).
        slots: Places of the tangents' entries, by rows, shape (K, D^2).
        evaluate: Residual (K, D) and its derivative (K, D, D) of each clique.
    """

    name: str
    dofs: IntArray
    slots: IntArray
    evaluate: Callable[[Configuration], tuple[FloatArray, FloatArray]]

    @classmethod
    def of(
        cls,
        name: str,
        dofs: IntArray,
        pattern: Pattern,
        evaluate: Callable[[Configuration], tuple[FloatArray, FloatArray]],
    ) -> BoundCliques:
        """Look the entries up."""
        size = dofs.shape[1]
        slots = pattern.slots_of(np.repeat(dofs, size, axis=1), np.tile(dofs, (1, size)))
        return cls(name, dofs, slots, evaluate)

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the force."""
        np.add.at(r, self.dofs, self.evaluate(c)[0])

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangent."""
        residual, tangent = self.evaluate(c)
        np.add.at(into.residual, self.dofs, residual)
        np.add.at(into.stiffness, self.slots, tangent.reshape(self.slots.shape))
