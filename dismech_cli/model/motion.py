"""Prescribed motions: which DOFs are held, on which path, and until when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from .laws import Law


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


def prescribe(motions: Sequence[Motion], q: FloatArray, t: float) -> None:
    """Write the prescribed values at the end time ``t`` of a step into ``q``."""
    for motion in motions:
        if t <= motion.release:
            q[motion.dofs] = motion.reference + motion.law(t)
