"""The search of `dismech study` against brute force: tables of five scenes with every combination.

`benchmarks/trade_tables.py` makes the tables. What is true is a finer run than any in them, extrapolated in
the mesh.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dismech_cli.scenario.language.study import Measured
from dismech_cli.scenario.load import load
from dismech_cli.studies.study.errors import Yardstick
from dismech_cli.studies.study.given_study import given_over
from dismech_cli.studies.study.measure import Point
from dismech_cli.studies.study.refine import Found
from dismech_cli.studies.study.search import Search
from dismech_cli.studies.study.space import Setting, Space, make_space

ROOT = Path(__file__).parents[2]
TABLES = sorted((ROOT / "tests" / "data" / "trade").glob("*.json"))
TARGETS = (0.1, 0.05, 0.03, 0.02, 0.01)


@dataclass(frozen=True)
class Table:
    """All runs of a scene."""

    space: Space
    points: dict[tuple[Setting, ...], Point]
    true: np.ndarray
    t_end: float

    def error(self, point: Point) -> float:
        """Its true error, as a share of the range."""
        if not point.stable:
            return inf
        return float(np.abs(point.courses["q"][1] - self.true).max() / np.ptp(self.true))

    def at(self, *key: int) -> Point:
        return self.points[self.space.settings(*key)]

    def cheapest_robust(self, target: float) -> float:
        """CPU of the cheapest run that meets a target with its finer neighbours; infinite if none does."""
        space, cheapest = self.space, inf
        last_time, last_mesh = len(space.time) - 1, len(space.mesh) - 1
        for m in range(len(space.methods)):
            for t in range(last_time + 1):
                for h in range(last_mesh + 1):
                    around = [(m, t, h), (m, min(t + 1, last_time), h), (m, t, min(h + 1, last_mesh))]
                    if all(self.error(self.at(*key)) <= target for key in around):
                        cheapest = min(cheapest, self.at(m, t, h).cpu)
        return cheapest


@cache
def _table(file: Path) -> Table:
    data: dict[str, Any] = json.loads(file.read_text())
    scene, *overrides = data["base"]
    space = make_space(load(ROOT / scene, overrides=overrides), given_over(data["axes"]))
    true = np.array(data["true"])
    times = np.linspace(0.0, data["t_end"], len(true))
    points = {}
    for one in data["points"]:
        courses = {} if one["course"] is None else {"q": (times, np.array(one["course"]))}
        settings = tuple(one["settings"].items())
        points[settings] = Point(
            settings=settings,
            status=one["status"],
            message="",
            cpu=one["cpu"],
            steps=one["steps"],
            iterations=one["iterations"],
            cuts=one["cuts"],
            size=one["size"],
            order=one["order"],
            t_end=data["t_end"],
            courses=courses,
        )
    return Table(space, points, true, data["t_end"])


def _searched(table: Table, target: float) -> tuple[Search, list[Found]]:
    spent: list[Point] = []

    def run(settings: tuple[Setting, ...], price: float) -> Point:
        if settings not in table.points:  # a stretched step, of which no table knows
            return Point(
                settings=settings, status="failed", message="", cpu=0.0, steps=0, iterations=0, cuts=0,
                size=0.0, order=2, t_end=table.t_end, courses={},
            )  # fmt: skip
        spent.append(table.points[settings])
        return spent[-1]

    search = Search(table.space, run, Yardstick({"q": Measured(probe="q")}, table.t_end), target)
    return search, search.find()


def test_there_are_five_tables() -> None:
    assert len(TABLES) == 5


def _claims() -> list[tuple[Path, float, Found, Search]]:
    found = []
    for file in TABLES:
        for target in TARGETS:
            search, results = _searched(_table(file), target)
            found.append((file, target, results[0], search))
    return found


def test_claims_are_true() -> None:
    """Nine of ten, and none by more than a quarter."""
    claims = [
        (_table(file).error(one.point) / target, one) for file, target, one, _ in _claims() if one.meets
    ]
    excess = np.array([share for share, _ in claims])
    assert len(excess) >= 10
    assert excess.max() <= 1.25
    assert np.mean(excess <= 1.0) >= 0.9


def test_what_is_found_is_cheap() -> None:
    """Against the cheapest run that meets the target with its finer neighbours, in CPU time.

    Levels are a factor of two apart, and a step between them, which the search ends with, is in no table.
    """
    ratios = [
        one.point.cpu / _table(file).cheapest_robust(target)
        for file, target, one, _ in _claims()
        if one.meets
    ]
    assert np.mean(ratios) <= 1.7
    assert max(ratios) <= 3.2


def test_few_runs_are_made() -> None:
    for file, _, _, search in _claims():
        table = _table(file)
        assert len(search.points) <= 0.4 * table.space.count, file.stem
    runs = [len(search.points) / _table(file).space.count for file, _, _, search in _claims()]
    assert np.mean(runs) <= 0.3


def test_little_time_is_spent() -> None:
    shares = []
    for file, _, one, search in _claims():
        whole = sum(point.cpu for point in _table(file).points.values())
        if one.meets:
            shares.append(sum(point.cpu for point in search.points.values()) / whole)
    assert np.mean(shares) <= 0.2


@pytest.mark.parametrize("file", TABLES, ids=lambda file: file.stem)
def test_an_unreachable_target_is_told(file: Path) -> None:
    _, found = _searched(_table(file), 1e-7)
    assert not found[0].meets
    assert "add a level" in found[0].reason


@pytest.mark.parametrize("file", TABLES, ids=lambda file: file.stem)
def test_brute_force_finds_what_meets_the_target(file: Path) -> None:
    table = _table(file)
    search = Search(
        table.space,
        lambda settings, price: table.points[settings],
        Yardstick({"q": Measured(probe="q")}, table.t_end),
        0.1,
    )
    (found,) = search.find_among_all()
    assert len(search.points) == table.space.count
    if found.meets:
        assert table.error(found.point) <= 0.125
