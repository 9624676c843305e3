"""What elastic terms know of themselves, driven or not."""

from __future__ import annotations

from typing import Protocol

from ..arrays import BoolArray, FloatArray
from .term import Term


class Elastic(Term, Protocol):
    """A term with natural strains."""

    @property
    def shares(self) -> tuple[str, ...]:
        """Names of its parts in the energy account."""

    def natural_at(self, t: float, inputs: FloatArray) -> FloatArray:
        """Natural strains at time ``t`` [s] under inputs (K,), shape (naturals, S)."""

    def touching(self, dofs: BoolArray) -> Term | None:
        """What of it acts on any of some DOFs, given as a mask (n,); None if nothing does.

        The rest of the term may be left out, but need not be.
        """
