"""What all runs of a study tell together: the errors of each, and the cheapest that meets a target."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from math import inf
from typing import Final, NamedTuple

from .estimate import Estimate
from .gap import NONE, Gap
from .measure import Point
from .refine import Found
from .runs import Key, Runs
from .space import Space

_UNREACHED: Final = "no setting meets the target together with its finer neighbours: add a level"
# Stable runs on a line of several levels that tell the error of its finest.
_COMPARED: Final = 2


class Errors(NamedTuple):
    """Of a run: by its steps and by its mesh; together as the first where right values are known."""

    time: Gap
    mesh: Gap

    @property
    def both(self) -> float:
        """Both together, as a share."""
        return (self.time + self.mesh).size


def find_among_all(runs: Runs, target: float) -> list[Found]:
    """Make every run, and take the cheapest that meets the target with its finer neighbours."""
    space = runs.space
    levels = (len(space.methods), len(space.time), len(space.mesh))
    for key in product(*map(range, levels)):
        runs.at(*key)
    known = known_errors(runs)
    errors = {key: one.both for key, one in known.items()}

    def found(key: Key, reason: str = "") -> Found:
        return Found(
            runs.points[key], Estimate(known[key].time), Estimate(known[key].mesh), not reason, reason
        )

    robust = [key for key in errors if all(errors.get(k, inf) <= target for k in _finer(space, key))]
    if robust:
        return [found(min(robust, key=lambda key: runs.points[key].cpu))]
    return [found(key, _UNREACHED) for key in sorted(errors, key=lambda key: errors[key])[:1]]


def _finer(space: Space, key: Key) -> set[Key]:
    """A point and the next finer ones."""
    method, time, mesh = key
    finer_time, finer_mesh = min(time + 1, len(space.time) - 1), min(mesh + 1, len(space.mesh) - 1)
    return {key, (method, finer_time, mesh), (method, time, finer_mesh)}


def known_errors(runs: Runs) -> Mapping[Key, Errors]:
    """Errors of all runs that lie on lines of levels whose finest error is known."""
    if runs.yardstick.known:
        return {
            key: Errors(runs.yardstick.error(one.courses), NONE)
            for key, one in runs.points.items()
            if one.stable and not runs.yardstick.is_reference(one.courses)
        }
    steps: dict[tuple[int, int], Gap] = {}
    shapes: dict[int, Gap] = {}
    for method, mesh in sorted({(m, h) for m, _, h in runs.points}):
        line = _line(runs, (method, None, mesh))
        if len(line) >= min(len(runs.space.time), _COMPARED):
            for key, gap in _along(runs, line, runs.along_time([one for _, one in line[-3:]])):
                steps.setdefault(key[:2], gap)
    for method, time in sorted({(m, t) for m, t, _ in runs.points}):
        line = _line(runs, (method, time, None))
        if len(line) >= min(len(runs.space.mesh), _COMPARED):
            for key, gap in _along(runs, line, runs.along_meshes([one for _, one in line[-3:]])):
                shapes[key[2]] = max(shapes.get(key[2], NONE), gap, key=lambda one: one.size)
    return {
        key: Errors(steps[key[:2]], shapes[key[2]])
        for key, one in runs.points.items()
        if one.stable and key[:2] in steps and key[2] in shapes
    }


def _line(runs: Runs, at: tuple[int, int | None, int | None]) -> list[tuple[Key, Point]]:
    """Stable runs of an alternative on a line, the coarsest first: None is the level that varies."""
    found = [
        (key, one)
        for key, one in runs.points.items()
        if one.stable and all(want in (None, has) for want, has in zip(at, key, strict=True))
    ]
    return sorted(found, key=lambda pair: pair[0])


def _along(runs: Runs, line: list[tuple[Key, Point]], top: Estimate) -> Iterator[tuple[Key, Gap]]:
    """Errors along a line: the distance to its finest run, and the error of that."""
    finest = line[-1][1]
    for key, one in line:
        yield key, runs.yardstick.gap(one.courses, finest.courses) + top.gap
