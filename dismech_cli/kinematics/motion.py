"""Prescribed motions: which DOFs are held, on which path, and until when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..laws.laws import Law


@dataclass(frozen=True, slots=True)
class Motion:
    """DOFs that follow reference + law(t) until they are released.

    Attributes:
        name: Label for messages.
        dofs: Held DOFs, shape (K,).
        reference: Values at rest [m, rad], shape (K,).
        law: Common increment [m, rad] over time.
        release: Time [s] from which the DOFs are free.
    """

    name: str
    dofs: IntArray
    reference: FloatArray
    law: Law
    release: float = inf


def held_dofs(motions: Sequence[Motion], n: int, t: float) -> BoolArray:
    """Mask of the DOFs held during a step that starts at time ``t``, shape (n,)."""
    held = np.zeros(n, dtype=bool)
    for motion in motions:
        if t < motion.release:
            held[motion.dofs] = True
    return held


def moving_dofs(motions: Sequence[Motion], q: FloatArray, v: FloatArray, t: float) -> IntArray:
    """DOFs held from time ``t`` on that ever move: not those that stay where they started, at rest.

    Args:
        motions: All motions.
        q: Where the run started, shape (n,).
        v: Velocity there, shape (n,).
        t: Start of a step [s].
    """
    moving = np.zeros(len(q), dtype=bool)
    for motion in motions:
        if t < motion.release:
            start = motion.reference + motion.law(0.0)
            stays = motion.law.constant & (start == q[motion.dofs]) & (v[motion.dofs] == 0.0)
            moving[motion.dofs] = ~stays
    return np.flatnonzero(moving)


def held_span(motions: Sequence[Motion], t: float) -> tuple[float, float]:
    """Times [s] around ``t``, from when and until when, between which no motion lets go."""
    releases = [motion.release for motion in motions]
    since = max((release for release in releases if release <= t), default=-inf)
    return since, min((release for release in releases if release > t), default=inf)


def prescribe(motions: Sequence[Motion], q: FloatArray, t: float) -> None:
    """Write the prescribed values at the end time ``t`` of a step into ``q``."""
    for motion in motions:
        if t <= motion.release:
            q[motion.dofs] = motion.reference + motion.law(t)
