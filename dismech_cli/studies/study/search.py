"""The search for the cheapest setting that meets a target, in a few runs of all that could be made.

1. Every alternative is raced at its two coarsest stable steps, on a coarse mesh: from their difference
   follows what it would cost at half the target. The best goes on, and what is within 1.6 of it.
2. Errors of step and mesh are estimated apart, each along its own line of levels, and added at every time of
   the run: where they cancel they do so by chance. The mesh is looked at with the coarsest step, once for
   all alternatives.
3. Whichever is more than half the target is refined, until their sum meets it, or no level is left.
4. The cheapest that does is the answer; its step is stretched by what is left of the target, with the order
   that was observed.
"""

from __future__ import annotations

from math import ceil, inf, log
from typing import Final, NamedTuple

from .estimate import Estimate, believed
from .refine import Found, Refinement
from .runs import Runs
from .space import stretched

# Alternatives go on up to this much dearer than the best of the race.
_CLOSE: Final = 1.6
# A stretch of the last step below this is not tried.
_WORTH: Final = 1.15


class Race(NamedTuple):
    """What two coarse steps of an alternative promise.

    Attributes:
        cost: Predicted at half the target; infinite if no two levels are stable.
        coarsest: Stable level of time.
        goal: Level that the prediction leads to.
    """

    cost: float
    coarsest: int
    goal: int


def find(runs: Runs, target: float) -> list[Found]:
    """What every alternative that was worth it came to, the cheapest that meets the target first.

    Args:
        runs: Makes them.
        target: Largest error allowed, as a share.
    """
    mesh = min(1, len(runs.space.mesh) - 1)
    races = [_race(runs, target, method, mesh) for method in range(len(runs.space.methods))]
    best = min(race.cost for race in races)
    if best == inf:
        return []
    found = [
        Refinement(runs, target, method, race.coarsest, mesh).found(race.goal)
        for method, race in enumerate(races)
        if race.cost <= _CLOSE * best
    ]
    found.sort(key=lambda one: (not one.meets, one.point.cpu if one.meets else one.error))
    if found[0].meets:
        found[0] = _stretched(runs, target, found[0])
    return found


def _race(runs: Runs, target: float, method: int, mesh: int) -> Race:
    levels, ratio = len(runs.space.time), runs.space.time.ratio
    if levels == 1:
        point = runs.at(method, 0, mesh)
        return Race(point.cpu if point.stable else inf, 0, 0)
    for time in range(1, levels):
        coarse, fine = runs.at(method, time - 1, mesh), runs.at(method, time, mesh)
        if not (coarse.stable and fine.stable):
            continue
        order = runs.space.time_order(fine.order)
        if runs.yardstick.known:
            error = runs.yardstick.error(fine.courses).size
        else:
            error = runs.yardstick.gap(coarse.courses, fine.courses).size / (ratio**order - 1.0)
        more = max(log(max(error, 1e-300) / (0.5 * target)), 0.0) / (log(ratio) * order)
        goal = min(max(time + ceil(more - 0.1), min(time + 1, levels - 1)), levels - 1)
        return Race(fine.cpu * ratio**more, time - 1, goal)
    return Race(inf, 0, 0)


def _stretched(runs: Runs, target: float, found: Found) -> Found:
    """The same with a longer step, where the target leaves room for one."""
    time, space = found.time.error, runs.space
    left = target - (found.error - time)
    if space.time.keys != ("numerics.dt",) or runs.yardstick.known or time <= 0.0:
        return found
    order = believed(found.time.order, space.time_order(found.point.order))
    factor = min((left / time) ** (1.0 / order), space.time.ratio)
    if factor < _WORTH:
        return found
    point = runs.between(stretched(found.point.settings, factor / 1.05))
    if not point.stable:
        return found
    steps = Estimate(
        found.time.gap + runs.yardstick.gap(point.courses, found.point.courses), found.time.order
    )
    longer = Found(point, steps, found.mesh, True)
    return found if longer.error > target or point.cpu >= found.point.cpu else longer
