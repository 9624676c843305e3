"""How stiff contact is: as given, or as stiff as a tolerance of penetration asks for.

One factor scales the stiffness of all pairs. It changes between steps only and follows from accepted states,
so that a resumed run takes the same decisions.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, log, log1p
from typing import ClassVar, Final, Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen

# A step deeper than the tolerance is taken again, so often at most, with a factor raised by a power of the
# depth: that which crossing lines need or which the last time showed, and a little more, within bounds.
_REDOS: Final = 4
_POWER, _MORE, _LEAST, _MOST = 1.5, 1.2, 2.0, 64.0
# After so many steps shallower than this part of the tolerance the factor is halved.
_CALM, _SHALLOW = 50, 0.25
# What was too deep before a step may get deeper by so much without more stiffness.
_DEEPER: Final = 1.05
# A collision of a step or longer has to be stopped by a force of so much of the kinetic energy per depth.
_IMPACT: Final = 1.25


@frozen
class Hardness:
    """What a step depends on.

    Attributes:
        factor: Scale of all stiffnesses.
        calm: Steps that were far shallower than the tolerance, in a row.
        mark: Depth in units of the tolerance that no raise could prevent; 0 once it is past.
        redos: How often this step was taken again.
        tried: Factor and depth of the last time.
    """

    factor: float = 1.0
    calm: int = 0
    mark: float = 0.0
    redos: int = 0
    tried: tuple[float, float] = (1.0, inf)


class Rule(Protocol):
    """Decides on the stiffness."""

    @property
    def tolerance(self) -> float:
        """Penetration that is allowed, as a share of the thickness."""

    def before(self, now: Hardness, needed: float) -> Hardness:
        """At the start of a step, before which an impact asks for a factor."""

    def after(self, now: Hardness, depth: float) -> Hardness:
        """After a step.

        Args:
            now: As it was in the step.
            depth: Depth at its end in units of the tolerance.

        Returns:
            For the next step; with one redo more if this one must be taken again.
        """


@frozen
class Given:
    """The stiffness of the user, whatever the depth.

    Attributes:
        tolerance: Penetration beyond which the run is doubtful.
    """

    tolerance: ClassVar[float] = 0.2

    def before(self, now: Hardness, needed: float) -> Hardness:
        """Unchanged."""
        return now

    def after(self, now: Hardness, depth: float) -> Hardness:
        """Unchanged."""
        return now


@frozen
class Tolerant:
    """Raised where an impact needs it or a step came too deep, lowered when all is calm.

    Attributes:
        tolerance: Penetration that is allowed, as a share of the thickness.
    """

    tolerance: float

    def before(self, now: Hardness, needed: float) -> Hardness:
        """Raised to what is needed."""
        return replace(now, factor=max(now.factor, needed))

    def after(self, now: Hardness, depth: float) -> Hardness:
        """Raised where too deep, by a power of the depth; halved after many shallow steps.

        What could not be held is brought out by forces in its own time: only if it gets deeper still is it
        held harder.
        """
        if depth > max(1.0, _DEEPER * now.mark):
            if now.redos == _REDOS:
                return given_up(now, depth)
            power = _POWER
            factor, last = now.tried
            if now.redos and depth < last:
                power = max(power, log(now.factor / factor) / log1p((last - depth) / depth))
            # what hardly gets shallower asks for any power
            power = min(power, log(_MOST) / log(depth))
            raised = min(max(_MORE * depth**power, _LEAST), _MOST)
            return Hardness(now.factor * raised, 0, now.mark, now.redos + 1, (now.factor, depth))
        calm = now.calm + 1 if depth < _SHALLOW else 0
        mark = now.mark if depth > 1.0 else 0.0
        if calm < _CALM:
            return Hardness(now.factor, calm, mark)
        return Hardness(max(0.5 * now.factor, 1.0), 0, mark)


def given_up(now: Hardness, depth: float) -> Hardness:
    """After a step that stays as deep as it is."""
    return Hardness(now.factor, 0, depth)


def impact_force(mass: FloatArray, speed: FloatArray, depth: FloatArray, dt: float) -> FloatArray:
    """Force that stops a mass within a depth, or within a step where that is longer [N], shape (K,).

    Args:
        mass: Reduced mass [kg], shape (K,).
        speed: Of approach [m/s], shape (K,).
        depth: Allowed [m], shape (K,).
        dt: Step [s].
    """
    force: FloatArray = mass * speed * np.minimum(1.0 / dt, _IMPACT * speed / depth)
    return force


def asked_for(force: FloatArray, held: FloatArray, groups: IntArray) -> float:
    """Factor with which what comes is stopped, by group: all of it together, by all that is faced.

    A sheet comes down on one of its corners first, and tips hold next to nothing: a factor that let the line
    that holds least stop all of its own would be a hundred times what the sheet needs. Where one place gets
    too deep for that, the step is taken again.

    Args:
        force: Needed of each line [N], shape (K,).
        held: What it holds at factor one as deep as it may be [N], shape (K,).
        groups: Numbers of groups, shape (K,).
    """
    needed, there = np.bincount(groups, weights=force), np.bincount(groups, weights=held)
    return float((needed / (there + np.finfo(float).tiny)).max(initial=0.0))
