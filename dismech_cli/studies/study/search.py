"""The search for the cheapest setting that meets a target, in a few runs of all that could be made.

1. Every alternative is raced at its two coarsest stable steps, on a coarse mesh: from their difference
   follows what it would cost at half the target. The best goes on, and what is within 1.6 of it.
2. Errors of step and mesh are estimated apart, each along its own line of levels, and added: where they
   cancel they do so by chance. The mesh is looked at with the coarsest step, once for all alternatives.
3. Whichever is more than half the target is refined, until their sum meets it, or no level is left.
4. The cheapest that does is the answer; its step is stretched by what is left of the target.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise, product
from math import ceil, inf, log
from typing import Final

from ...errors import ScenarioError
from .errors import NO_ERROR, Estimate, Yardstick, estimate
from .measure import Point
from .refine import Found, Key, Refinement
from .space import Setting, Space, stretched

# Alternatives go on up to this much dearer than the best of the race.
_CLOSE: Final = 1.6
_UNREACHED: Final = "no setting meets the target together with its finer neighbours: add a level"
# A stretch of the last step below this is not tried.
_WORTH: Final = 1.15

Run = Callable[[tuple[Setting, ...], float], Point]
"""Makes a run, at a price per step and degree of freedom [s] that others had; infinite if none is known."""


@dataclass
class Search:
    """One search; remembers all runs.

    Attributes:
        space: What is tried.
        run: Makes a run.
        yardstick: Compares them.
        target: Largest error allowed.
        points: Runs by alternative and levels of time and mesh.
        extra: Further runs, between levels.
    """

    space: Space
    run: Run
    yardstick: Yardstick
    target: float
    points: dict[Key, Point] = field(default_factory=dict)
    extra: list[Point] = field(default_factory=list)
    _price: float = inf

    def at(self, method: int, time: int, mesh: int) -> Point:
        """The run of a point, made once."""
        key = (method, time, mesh)
        if key not in self.points:
            first = not any(one.stable for one in self.points.values())
            point = self.points[key] = self._made(self.space.settings(*key))
            if first and point.stable:
                self.yardstick.start(point.courses)
        return self.points[key]

    def _made(self, settings: tuple[Setting, ...]) -> Point:
        point = self.run(settings, self._price)
        if point.stable and point.cpu > 0.0:
            self._price = min(self._price, point.cpu / point.size)
        return point

    # -- estimates -----------------------------------------------------------------------------------------

    def time_error(self, method: int, time: int, mesh: int) -> Estimate:
        """Error of the steps of a level, from it and up to two coarser ones."""
        point = self.at(method, time, mesh)
        return self._along(
            [self.at(method, k, mesh) for k in range(max(time - 2, 0), time + 1)],
            self.space.time.ratio,
            self.space.time_order(point.order),
        )

    def mesh_error(self, method: int, time: int, mesh: int) -> Estimate:
        """Error of a mesh, from it and up to two coarser ones."""
        points = [self.at(method, time, k) for k in range(max(mesh - 2, 0), mesh + 1)]
        return self._along(points, self.space.mesh.ratio, self.space.mesh_order)

    def _along(self, points: list[Point], ratio: float, order: float) -> Estimate:
        if not points[-1].stable:
            return Estimate(inf, steady=False)
        if self.yardstick.is_reference(points[-1].courses):
            return Estimate(inf, steady=False)
        if self.yardstick.known:
            return Estimate(self.yardstick.error(points[-1].courses))
        stable = [one for one in points if one.stable]
        if len(points) == 1:
            return NO_ERROR
        if len(stable) < 2:
            return Estimate(inf, steady=False)
        differences = [self.yardstick.distance(a.courses, b.courses) for a, b in pairwise(stable)]
        return estimate(differences, ratio, order)

    # -- the search ----------------------------------------------------------------------------------------

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

    def find(self) -> list[Found]:
        """What every alternative that was worth it came to, the cheapest that meets the target first."""
        mesh = min(1, len(self.space.mesh) - 1)
        races = [self._race(method, mesh) for method in range(len(self.space.methods))]
        best = min(cost for cost, _, _ in races)
        if best == inf:
            return []
        kept = [(method, race) for method, race in enumerate(races) if race[0] <= _CLOSE * best]
        found = [Refinement(self, method, race[1], mesh).found(race[2]) for method, race in kept]
        found.sort(key=lambda one: (not one.meets, one.point.cpu if one.meets else one.error))
        if found[0].meets:
            found[0] = self._stretched(found[0])
        return found

    def find_among_all(self) -> list[Found]:
        """The same after every run was made: the cheapest that meets the target with its finer neighbours."""
        space = self.space
        for method, time, mesh in product(
            range(len(space.methods)), range(len(space.time)), range(len(space.mesh))
        ):
            self.at(method, time, mesh)
        shares = self._known_shares()
        errors = {key: sum(pair) for key, pair in shares.items()}

        def found(key: Key, reason: str = "") -> Found:
            steps, shape = map(Estimate, shares[key])
            return Found(self.points[key], steps, shape, not reason, reason)

        robust = [key for key in errors if all(errors.get(k, inf) <= self.target for k in self._finer(key))]
        if robust:
            return [found(min(robust, key=lambda key: self.points[key].cpu))]
        return [found(key, _UNREACHED) for key in sorted(errors, key=lambda key: errors[key])[:1]]

    def _finer(self, key: Key) -> set[Key]:
        """A point and the next finer ones."""
        method, time, mesh = key
        finer_time = min(time + 1, len(self.space.time) - 1)
        finer_mesh = min(mesh + 1, len(self.space.mesh) - 1)
        return {key, (method, finer_time, mesh), (method, time, finer_mesh)}

    def _race(self, method: int, mesh: int) -> tuple[float, int, int]:
        """Predicted cost at half the target, the coarsest stable level, and the level that it leads to."""
        levels = len(self.space.time)
        if levels == 1:
            point = self.at(method, 0, mesh)
            return (point.cpu if point.stable else inf), 0, 0
        for time in range(1, levels):
            coarse, fine = self.at(method, time - 1, mesh), self.at(method, time, mesh)
            if not (coarse.stable and fine.stable):
                continue
            if self.yardstick.known:
                error = self.yardstick.error(fine.courses)
            else:
                order = self.space.time_order(fine.order)
                distance = self.yardstick.distance(coarse.courses, fine.courses)
                error = distance / (self.space.time.ratio**order - 1.0)
            more = max(log(max(error, 1e-300) / (0.5 * self.target)), 0.0)
            more /= log(self.space.time.ratio) * self.space.time_order(fine.order)
            goal = min(max(time + ceil(more - 0.1), min(time + 1, levels - 1)), levels - 1)
            return fine.cpu * self.space.time.ratio**more, time - 1, goal
        return inf, 0, 0

    def _stretched(self, found: Found) -> Found:
        """The same with a longer step, where the target leaves room for one."""
        time, left = found.time.error, self.target - found.mesh.error
        if self.space.time.keys != ("numerics.dt",) or self.yardstick.known or time <= 0.0:
            return found
        order = self.space.time_order(found.point.order)
        factor = min((left / time) ** (1.0 / order), self.space.time.ratio)
        if factor < _WORTH:
            return found
        point = self._made(stretched(found.point.settings, factor / 1.05))
        self.extra.append(point)
        if not point.stable:
            return found
        error = time + self.yardstick.distance(point.courses, found.point.courses)
        if error > left or point.cpu >= found.point.cpu:
            return found
        return Found(point, Estimate(error, found.time.order), found.mesh, True)

    # -- what the runs tell ----------------------------------------------------------------------------------

    def known_errors(self) -> dict[Key, float]:
        """Errors of all runs that lie on lines of levels whose finest error is known."""
        return {key: sum(pair) for key, pair in self._known_shares().items()}

    def _known_shares(self) -> dict[Key, tuple[float, float]]:
        """The same of steps and of the mesh; both together as the first where right values are known."""
        if self.yardstick.known:
            found = (
                (key, one)
                for key, one in self.points.items()
                if one.stable and not self.yardstick.is_reference(one.courses)
            )
            return {key: (self.yardstick.error(one.courses), 0.0) for key, one in found}
        steps: dict[tuple[int, int], float] = {}
        shapes: dict[int, float] = {}
        for method, mesh in sorted({(m, h) for m, _, h in self.points}):
            line = self._line((method, None, mesh))
            order = self.space.time_order(line[-1][1].order) if line else 1.0
            for key, error in self._line_errors(line, self.space.time.ratio, order, len(self.space.time)):
                steps.setdefault((method, key[1]), error)
        for method, time in sorted({(m, t) for m, t, _ in self.points}):
            line = self._line((method, time, None))
            ratio, order = self.space.mesh.ratio, self.space.mesh_order
            for key, error in self._line_errors(line, ratio, order, len(self.space.mesh)):
                shapes[key[2]] = max(shapes.get(key[2], 0.0), error)
        return {
            key: (steps[key[:2]], shapes[key[2]])
            for key, one in self.points.items()
            if one.stable and key[:2] in steps and key[2] in shapes
        }

    def _line(self, at: tuple[int, int | None, int | None]) -> list[tuple[Key, Point]]:
        """Stable runs of an alternative on a line, the coarsest first: None is the level that varies."""
        found = [
            (key, one)
            for key, one in self.points.items()
            if one.stable and all(want in (None, has) for want, has in zip(at, key, strict=True))
        ]
        return sorted(found, key=lambda pair: pair[0])

    def _line_errors(
        self, line: list[tuple[Key, Point]], ratio: float, order: float, levels: int
    ) -> Iterator[tuple[Key, float]]:
        """Errors along a line: the distance to its finest run, and the error of that."""
        if not line or (len(line) == 1 and levels > 1):
            return
        finest = line[-1][1]
        top = self._along([one for _, one in line[-3:]], ratio, order).error
        for key, one in line:
            yield key, self.yardstick.distance(one.courses, finest.courses) + top

    def apart(self, one: Key, other: Key) -> float:
        """Distance of two runs that were made."""
        return self.yardstick.distance(self.points[one].courses, self.points[other].courses)
