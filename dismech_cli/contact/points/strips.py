"""Parts of lines that touch: points of contact, or pieces on which there are points when asked for."""

from __future__ import annotations

from typing import Protocol

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from .points import Points


@frozen
class Table:
    """Pieces of lines within reach of what they face, as compiled loops have them.

    Attributes:
        rows: Items that were looked at, shape (K,).
        piece_item: Which of these each piece is of; those of an item follow each other, shape (P,).
        pieces: See :mod:`.line_loops`, shape (P, columns).
        reach: H of the items [m], shape (K,).
        factor: Stiffness times rest length times sign of these [N/m], shape (K,).
    """

    rows: IntArray
    piece_item: IntArray
    pieces: FloatArray
    reach: FloatArray
    factor: FloatArray


class Strips(Protocol):
    """Parts of lines that touch what they face."""

    @property
    def points(self) -> Points:
        """Points of contact on them."""

    @property
    def table(self) -> Table | None:
        """The pieces, where compiled loops have them."""

    @property
    def curved(self) -> bool:
        """Whether their stiffness is more than that along the gaps."""
