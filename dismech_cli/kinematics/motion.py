"""Prescribed motions: which DOFs are held, on which path, and until when."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import ClassVar, Protocol

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..laws.laws import Law
from .rod_frames import FrameState


@frozen
class Since:
    """The accepted state that a trial point starts from.

    Attributes:
        t: Its time [s].
        q: Its shape, shape (n,).
        frames: Its frames.
    """

    t: float
    q: FloatArray
    frames: FrameState


class Prescribed(Protocol):
    """DOFs that follow a path until they are released."""

    @property
    def name(self) -> str:
        """Label for messages."""

    @property
    def dofs(self) -> IntArray:
        """Held DOFs, shape (K,)."""

    @property
    def release(self) -> float:
        """Time [s] from which the DOFs are free."""

    @property
    def remembers(self) -> bool:
        """Whether where they go depends on the last accepted state."""

    def stays(self, q: FloatArray, v: FloatArray) -> BoolArray:
        """Which of them never move from a start ``q`` with velocity ``v``, both (n,); shape (K,)."""

    def values(self, t: float, q: FloatArray, since: Since) -> FloatArray:
        """Their values at a time, shape (K,).

        Args:
            t: Time [s].
            q: What motions named before have prescribed there, shape (n,).
            since: The last accepted state.
        """


@frozen
class Motion:
    """DOFs that follow reference + law(t) until they are released.

    Attributes:
        name: Label for messages.
        dofs: Held DOFs, shape (K,).
        reference: Values at rest [m, rad], shape (K,).
        law: Increment [m, rad] over time.
        release: Time [s] from which the DOFs are free.
        places: Where the increment is asked for, as the law takes it: 0, or shape (K,).
    """

    name: str
    dofs: IntArray
    reference: FloatArray
    law: Law
    release: float = inf
    places: FloatArray | float = 0.0
    remembers: ClassVar[bool] = False

    def stays(self, q: FloatArray, v: FloatArray) -> BoolArray:
        """Which start where they are held for ever, at rest."""
        start = self.reference + self.law(0.0, self.places)
        stays: BoolArray = self.law.constant & (start == q[self.dofs]) & (v[self.dofs] == 0.0)
        return stays

    def values(self, t: float, q: FloatArray, since: Since) -> FloatArray:
        """Reference and increment."""
        return self.reference + self.law(t, self.places)


def held_dofs(motions: Sequence[Prescribed], n: int, t: float) -> BoolArray:
    """Mask of the DOFs held during a step that starts at time ``t``, shape (n,)."""
    held = np.zeros(n, dtype=bool)
    for motion in motions:
        if t < motion.release:
            held[motion.dofs] = True
    return held


def moving_dofs(motions: Sequence[Prescribed], q: FloatArray, v: FloatArray, t: float) -> IntArray:
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
            moving[motion.dofs] = ~motion.stays(q, v)
    return np.flatnonzero(moving)


def held_span(motions: Sequence[Prescribed], t: float) -> tuple[float, float]:
    """Times [s] around ``t``, from when and until when, between which no motion lets go."""
    releases = [motion.release for motion in motions]
    since = max((release for release in releases if release <= t), default=-inf)
    return since, min((release for release in releases if release > t), default=inf)


def prescribe(motions: Sequence[Prescribed], q: FloatArray, t: float, since: Since) -> None:
    """Write the prescribed values at the end time ``t`` of a step into ``q``."""
    for motion in motions:
        if t <= motion.release:
            q[motion.dofs] = motion.values(t, q, since)
