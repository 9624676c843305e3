"""CPU times that count, of runs so short that they scatter: the median of three."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import median
from typing import Final

from .measure import Point
from .refine import Found
from .space import Setting
from .studied import Row

# Runs longer than this even out by themselves what other programs and caches do to them [s].
_SHORT: Final = 2.0
_TIMES: Final = 3


def timed_again(
    rows: Sequence[Row], found: Sequence[Found], run: Callable[[tuple[Setting, ...]], Point]
) -> tuple[tuple[Row, ...], list[Found]]:
    """The same, where short runs of the frontier and of the answer have the median time of three.

    Args:
        rows: All runs.
        found: What alternatives came to, the answer first.
        run: Makes a run.
    """
    answers = {one.point.settings for one in found[:1] if one.meets}
    wanted = [row.point for row in rows if row.best or row.point.settings in answers]
    times = {one.settings: _median(one, run) for one in wanted if one.stable and one.cpu < _SHORT}

    def timed(point: Point) -> Point:
        return replace(point, cpu=times.get(point.settings, point.cpu))

    return (
        tuple(replace(row, point=timed(row.point)) for row in rows),
        [replace(one, point=timed(one.point)) for one in found],
    )


def _median(point: Point, run: Callable[[tuple[Setting, ...]], Point]) -> float:
    return median([point.cpu, *(run(point.settings).cpu for _ in range(_TIMES - 1))])
