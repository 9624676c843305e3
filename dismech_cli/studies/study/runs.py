"""The runs of a study, each made once, and what their levels tell of errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf

from ...errors import ScenarioError
from .estimate import LOST, NO_ERROR, Estimate, estimate
from .gap import Gap
from .measure import Point
from .space import Setting, Space
from .yardstick import Yardstick

Key = tuple[int, int, int]
"""Alternative, level of time, level of mesh."""

Run = Callable[[tuple[Setting, ...], float], Point]
"""Makes a run, at a price per step and degree of freedom [s] that others had; infinite if none is known."""


@dataclass
class Runs:
    """All that were made; more are made as they are asked for.

    Attributes:
        space: What is tried.
        run: Makes a run.
        yardstick: Compares them.
        points: By alternative and levels of time and mesh.
        extra: Further runs, between levels.
    """

    space: Space
    run: Run
    yardstick: Yardstick
    points: dict[Key, Point] = field(default_factory=dict)
    extra: list[Point] = field(default_factory=list)
    _price: float = inf

    def at(self, method: int, time: int, mesh: int) -> Point:
        """The run of a point."""
        key = (method, time, mesh)
        if key not in self.points:
            first = not any(one.stable for one in self.points.values())
            point = self.points[key] = self._made(self.space.settings(*key))
            if first and point.stable:
                self.yardstick.start(point.courses)
        return self.points[key]

    def between(self, settings: tuple[Setting, ...]) -> Point:
        """A further run, between levels."""
        self.extra.append(self._made(settings))
        return self.extra[-1]

    def _made(self, settings: tuple[Setting, ...]) -> Point:
        point = self.run(settings, self._price)
        if point.stable and point.cpu > 0.0:
            self._price = min(self._price, point.cpu / point.size)
        return point

    def measure_from_finest(self) -> None:
        """Take the finest run of the first alternative as right.

        Raises:
            ScenarioError: It is not stable.
        """
        point = self.at(0, len(self.space.time) - 1, len(self.space.mesh) - 1)
        if not point.stable:
            raise ScenarioError(
                f"study: the finest run, which was to be the reference, is unstable: {point.message}"
            )
        self.yardstick.measure_from(point.courses)

    def apart(self, one: Key, other: Key) -> Gap:
        """Distance of two runs that were made."""
        return self.yardstick.gap(self.points[one].courses, self.points[other].courses)

    def time_error(self, method: int, time: int, mesh: int) -> Estimate:
        """Error of the steps of a level, from it and up to two coarser ones."""
        return self.along_time([self.at(method, k, mesh) for k in range(max(time - 2, 0), time + 1)])

    def mesh_error(self, method: int, time: int, mesh: int) -> Estimate:
        """Error of a mesh, from it and up to two coarser ones."""
        return self.along_meshes([self.at(method, time, k) for k in range(max(mesh - 2, 0), mesh + 1)])

    def along_time(self, points: list[Point]) -> Estimate:
        """Error of the last of some runs that differ by levels of the step."""
        order = self.space.time_order(points[-1].order)
        return self._along(points, self.space.time.ratio, order)

    def along_meshes(self, points: list[Point]) -> Estimate:
        """Error of the last of some runs that differ by levels of the mesh."""
        return self._along(points, self.space.mesh.ratio, self.space.mesh_order)

    def _along(self, points: list[Point], ratio: float, order: float) -> Estimate:
        last = points[-1]
        if not last.stable or self.yardstick.is_reference(last.courses):
            return LOST
        if self.yardstick.known:
            return Estimate(self.yardstick.error(last.courses))
        stable = [one for one in points if one.stable]
        if len(points) == 1:
            return NO_ERROR
        if len(stable) < 2:
            return LOST
        gaps = [self.yardstick.gap(a.courses, b.courses) for a, b in pairwise(stable)]
        return estimate(gaps, ratio, order)
