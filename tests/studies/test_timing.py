"""CPU times of short runs that count: the median of three."""

from __future__ import annotations

from collections.abc import Iterator

from dismech_cli.studies.study.estimate import NO_ERROR
from dismech_cli.studies.study.measure import Point
from dismech_cli.studies.study.refine import Found
from dismech_cli.studies.study.space import Setting
from dismech_cli.studies.study.studied import Row
from dismech_cli.studies.study.timing import timed_again


def point(name: str, cpu: float) -> Point:
    return Point(
        settings=(("numerics.dt", name),), status="done", message="", cpu=cpu, steps=9, iterations=9, cuts=0,
        size=1.0, order=2, t_end=1.0, courses={},
    )  # fmt: skip


def test_short_runs_of_the_frontier_and_the_answer_are_timed_thrice() -> None:
    rows = [
        Row(point=point("front", 1.0), error=0.1, best=True),
        Row(point=point("behind", 1.0), error=0.2, best=False),
        Row(point=point("long", 50.0), error=0.01, best=True),
        Row(point=point("answer", 1.9), error=0.3, best=False),
    ]
    answer = Found(rows[3].point, NO_ERROR, NO_ERROR, meets=True)
    times: Iterator[float] = iter([0.5, 0.7, 3.0, 1.5])
    made: list[str] = []

    def run(settings: tuple[Setting, ...]) -> Point:
        made.append(settings[0][1])
        return point(settings[0][1], next(times))

    timed, found = timed_again(rows, [answer], run)
    assert made == ["front", "front", "answer", "answer"]
    assert [row.point.cpu for row in timed] == [0.7, 1.0, 50.0, 1.9]
    assert found[0].point.cpu == 1.9
