"""The barrier: an energy that grows without bounds as a distance falls to one that it must not reach.

With g the distance beyond the stop and R the range of the barrier, it is k (R - g)^2 down to half the range,
as soft as any penalty, and from there on 2 k h^2 (1/2 - ln(g / h)), h = R / 2: curvature and all are
continuous.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...frozen import frozen
from ...geometry.kernel import kernel
from .points import Points

_ROOM = 1e-6


@kernel
def barrier(gap: Any, reach: Any, stiffness: Any) -> Any:
    """Energy, slope and curvature at gaps g above 0 beyond the stop; infinite where there is none.

    Args:
        gap: g [m].
        reach: R [m].
        stiffness: k [N/m].
    """
    h = 0.5 * reach
    c = 2.0 * stiffness * h * h
    short = np.maximum(reach - gap, 0.0)
    near = gap < h
    safe = np.maximum(gap, 1e-150)
    energy = np.where(near, stiffness * h * h - c * np.log(safe / h), stiffness * short * short)
    slope = np.where(near, -c / safe, -2.0 * stiffness * short)
    curvature = np.where(near, c / (safe * safe), np.where(gap < reach, 2.0 * stiffness, 0.0))
    inside = gap <= 0.0
    return (
        np.where(inside, np.inf, energy),
        np.where(inside, -np.inf, slope),
        np.where(inside, np.inf, curvature),
    )


@frozen
class Stop:
    """What distance is kept, as shares of that at which things touch.

    Attributes:
        least: Nothing comes nearer.
        begin: Where the barrier begins.
    """

    least: float
    begin: float

    @property
    def nearest(self) -> float:
        """Where motion is stopped: far enough from the stop for rounding."""
        return self.least + _ROOM * (self.begin - self.least)


@frozen
class Closest:
    """Closest points of pairs, as in :mod:`.points`: the gap vector is a sum over n nodes.

    Attributes:
        item: Which pair, shape (K,).
        s: Place on the line, shape (K,).
        weights: Of the nodes in the gap, shape (n, K).
        spread: Slopes of the weights, shape (n, 3, K).
        gap: From what is faced to the line [m], shape (3, K).
        identity: Share of the identity in Q, shape (K,).
        axis: Share of e e^T in Q, shape (K,).
        e: Shape (3, K).
    """

    item: IntArray
    s: FloatArray
    weights: FloatArray
    spread: FloatArray
    gap: FloatArray
    identity: FloatArray
    axis: FloatArray
    e: FloatArray

    @property
    def distance(self) -> FloatArray:
        """[m], shape (K,)."""
        distance: FloatArray = np.sqrt((self.gap * self.gap).sum(axis=0))
        return distance

    def some(self, kept: IntArray | BoolArray) -> Closest:
        """Those of a mask or of indices."""
        return Closest(*(getattr(self, name)[..., kept] for name in self.__match_args__))


def barrier_points(at: Closest, stop: FloatArray, reach: FloatArray, stiffness: FloatArray) -> Points:
    """Points of contact of pairs with their barrier.

    Args:
        at: Closest points.
        stop: Distance that they must keep [m], shape (K,).
        reach: How far beyond it the barrier begins [m], shape (K,).
        stiffness: k [N/m], shape (K,).
    """
    return radial_points(at, at.distance, *barrier(at.distance - stop, reach, stiffness))


def radial_points(
    at: Closest, distance: FloatArray, energy: FloatArray, slope: FloatArray, curvature: FloatArray
) -> Points:
    """Points of contact of pairs whose energy depends on their distance alone.

    Args:
        at: Closest points.
        distance: Between them, not zero [m], shape (K,).
        energy: Of each [J], shape (K,).
        slope: Its derivative [N].
        curvature: Its second derivative [N/m].
    """
    pull = slope / distance
    return Points(
        item=at.item,
        s=at.s,
        weights=at.weights,
        spread=at.spread,
        gap=at.gap,
        normal=at.gap / distance,
        energy=energy,
        pull=pull,
        along=(curvature - pull) / (distance * distance),
        bend=pull,
        load=-slope,
        growth=-curvature,
        identity=at.identity,
        axis=at.axis,
        e=at.e,
        turn=1.0 / distance,
    )


def convex(points: Points) -> Points:
    """The same with the stiffness along the gap alone (Gauss and Newton): never negative."""
    distance = np.sqrt((points.gap * points.gap).sum(axis=0))
    return replace(points, along=-points.growth / distance**2, bend=np.zeros_like(points.bend))
