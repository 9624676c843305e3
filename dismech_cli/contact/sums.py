"""What pairs of bodies do to each other, summed over where they touch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..model.touch import Touch
from .gather.source import Depths
from .gather.touching import Touching
from .terms import FullFriction, SymmetricFriction


def summed(
    pairs: tuple[tuple[str, str], ...],
    touching: Sequence[Touching],
    depths: Sequence[Depths],
    rough: FullFriction | SymmetricFriction | None,
    nodes: int,
) -> Touch:
    """Forces on the first of each pair, places and depth.

    Args:
        pairs: Names of the pairs of bodies.
        touching: Where they touch.
        depths: How deep lines are in each other.
        rough: Their friction, if any.
        nodes: Number of all nodes.
    """
    count = len(pairs)
    normal, rubbed, load = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    counts, depth = np.zeros(count, dtype=np.int64), np.zeros(count)
    loads, forces = np.zeros(nodes), np.zeros((nodes, 3))
    for one in touching:
        points, sign = one.points, one.sign
        force = points.load * points.normal
        np.add.at(normal, one.label, (sign * force).T)
        np.add.at(load, one.label, points.load)
        if rough is not None:
            rub = rough.forces(one)
            np.add.at(rubbed, one.label, -(sign * rub).T)
            force = force - rub
        at, shares = one.stencils.nodes[points.item].T, points.weights
        # nodes that are faced have weights below zero: what presses on them is as large
        np.add.at(loads, at, np.abs(shares) * points.load)
        np.add.at(forces, at, (shares[:, None] * force).transpose(0, 2, 1))
    for deep in depths:
        np.maximum.at(depth, deep.labels, deep.shares)
        np.add.at(counts, deep.labels, deep.shares > 0.0)
    return Touch(pairs, counts, normal, rubbed, load, depth, loads, forces)


def deepest(lines: int, depths: Sequence[Depths]) -> FloatArray:
    """Penetration of each of all lines as a share of its thickness, shape (lines,)."""
    out = np.zeros(lines)
    for found in depths:
        np.maximum.at(out, found.numbers, found.shares)
    return out


def worst(before: FloatArray, depths: Sequence[Depths], t: float) -> FloatArray:
    """Deepest penetration so far: its share of the thickness, its pair, its line and its time, shape (4,).

    Args:
        before: That before a step.
        depths: How deep lines are in each other at its end.
        t: Time of its end [s].
    """
    out = before
    for found in depths:
        if len(found.shares) and found.shares.max() > out[0]:
            k = int(np.argmax(found.shares))
            out = np.array([found.shares[k], found.labels[k], found.numbers[k], t])
    return out
