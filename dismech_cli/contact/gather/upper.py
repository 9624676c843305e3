"""Sums over what touches, to the upper triangles of items."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from ...arrays import FloatArray
from ...frozen import frozen
from .touching import Touching


class Stiff(Protocol):
    """Places of items of a kind, to which forces and stiffnesses are added."""

    def add_squares(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq to ``r`` (n,) and what the second derivatives have along the gaps to values (slots,)."""

    def add_hessians(self, touching: Touching, r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq to ``r`` and the second derivatives to stored values."""


class Upper(Stiff, Protocol):
    """Places to which tangents of friction are added too."""

    def add_symmetric(self, touching: Touching, block: FloatArray, values: FloatArray) -> None:
        """Add w_i w_j times a symmetric block (3, 3, K) of each point to stored values."""


@frozen
class Sums:
    """Places of items of all kinds.

    Attributes:
        kinds: By kind.
        finish: Brings to stored values (slots,) what is not there yet.
    """

    kinds: Sequence[Stiff]
    finish: Callable[[FloatArray], None]

    def add(self, touching: Sequence[Touching], r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq and the second derivatives, where they are more than what they have along the gaps."""
        for one in touching:
            kind = self.kinds[one.kind]
            (kind.add_hessians if one.strips.curved else kind.add_squares)(one, r, values)
        self.finish(values)

    def add_convex(self, touching: Sequence[Touching], r: FloatArray, values: FloatArray) -> None:
        """Add dE/dq and what the second derivatives have along the gaps (Gauss and Newton)."""
        for one in touching:
            self.kinds[one.kind].add_squares(one, r, values)
        self.finish(values)


def finished(values: FloatArray) -> None:
    """All is there."""
