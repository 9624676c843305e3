"""What finds things that touch: an obstacle with its lines, or bodies among themselves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...model.term import Memory
from .stencils import Stencils
from .touching import Touching


@frozen
class Depths:
    """How deep lines are in what they touch.

    Attributes:
        numbers: Of the lines among all, shape (K,).
        shares: Depth as a share of the thickness, 0 where nothing touches, shape (K,).
        labels: Numbers of the pairs of bodies, shape (K,).
    """

    numbers: IntArray
    shares: FloatArray
    labels: IntArray


class Source(Protocol):
    """Finds what touches; all places are nodes [m], shape (N, 3), and all velocities theirs."""

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of all items that have places in the matrix, by kind."""

    @property
    def steady(self) -> bool:
        """Whether the energy of a shape is the same at all times."""

    def recall(self, memory: Memory) -> None:
        """Take up what the last step left."""

    def memory(self, x: FloatArray) -> Memory:
        """What a step that ends at ``x`` leaves to the next."""

    def detect(self, x: FloatArray) -> bool:
        """Find the items at a trial point; True if those with places changed."""

    def touching(self, x: FloatArray, v: FloatArray, t: float, factor: float) -> Iterator[Touching]:
        """What touches, with all stiffnesses scaled by a factor."""

    def velocities(self, touching: Touching, x: FloatArray, v: FloatArray, t: float) -> FloatArray:
        """Relative velocities at points of contact with other velocities of the nodes, shape (3, K)."""

    def depths(self, x: FloatArray, t: float) -> Depths:
        """How deep what touches is."""

    def needed(self, x: FloatArray, ahead: FloatArray, t: float, dt: float, tolerance: float) -> float:
        """Factor of the stiffness that stops in time what comes in a step, from ``x`` to ``ahead``."""

    def longest_step(self, x0: FloatArray, x1: FloatArray, t0: float, t1: float) -> float:
        """Part of the way from ``x0`` to ``x1`` on which nothing passes through anything."""
