"""What pairs of bodies do to each other, summed over where they touch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..model.touch import Touch
from .source import Depths
from .terms import FullFriction, SymmetricFriction
from .touching import Touching


def summed(
    pairs: tuple[tuple[str, str], ...],
    touching: Sequence[Touching],
    depths: Sequence[Depths],
    rough: FullFriction | SymmetricFriction | None,
) -> Touch:
    """Forces on the first of each pair, places and depth.

    Args:
        pairs: Names of the pairs of bodies.
        touching: Where they touch.
        depths: How deep lines are in each other.
        rough: Their friction, if any.
    """
    count = len(pairs)
    normal, rubbed, load = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    counts, depth = np.zeros(count, dtype=np.int64), np.zeros(count)
    for one in touching:
        points, sign = one.points, one.sign
        np.add.at(normal, one.label, (sign * points.load * points.normal).T)
        np.add.at(load, one.label, points.load)
        if rough is not None:
            np.add.at(rubbed, one.label, -(sign * rough.forces(one)).T)
    for deep in depths:
        np.maximum.at(depth, deep.labels, deep.shares)
        np.add.at(counts, deep.labels, deep.shares > 0.0)
    return Touch(pairs, counts, normal, rubbed, load, depth)


def deepest(lines: int, depths: Sequence[Depths]) -> FloatArray:
    """Penetration of each of all lines as a share of its thickness, shape (lines,)."""
    out = np.zeros(lines)
    for found in depths:
        np.maximum.at(out, found.numbers, found.shares)
    return out
