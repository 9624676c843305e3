"""The search of `dismech study` against brute force: tables of scenes with every combination.

`benchmarks/trade_tables.py` makes the tables. What is true is a finer run than any in them, extrapolated in
the mesh.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from benchmarks.trade_tables import FOLDER, HELD_OUT, TARGETS, Table, read, runs_of
from dismech_cli.studies.study.every import find_among_all
from dismech_cli.studies.study.refine import Found
from dismech_cli.studies.study.runs import Runs
from dismech_cli.studies.study.search import find
from dismech_cli.studies.study.space import Line, Space

ALL = sorted(FOLDER.glob("*.json"))
HELD = [file for file in ALL if file.stem in HELD_OUT]
TUNED = [file for file in ALL if file.stem not in HELD_OUT]


@cache
def _table(file: Path) -> Table:
    return read(file)


@cache
def _claims() -> list[tuple[Path, float, Found, Runs]]:
    found = []
    for file in ALL:
        for target in TARGETS:
            runs = runs_of(_table(file))
            found.append((file, target, find(runs, target)[0], runs))
    return found


def test_some_tables_were_not_looked_at_while_the_search_was_made() -> None:
    assert (len(TUNED), len(ALL)) == (5, 5 + len(HELD_OUT))


def test_claims_are_true() -> None:
    """Nine of ten, and none by more than a quarter."""
    claims = [
        (_table(file).error(one.point) / target, one) for file, target, one, _ in _claims() if one.meets
    ]
    excess = np.array([share for share, _ in claims])
    assert len(excess) >= 10
    assert excess.max() <= 1.25
    assert np.mean(excess <= 1.0) >= 0.9


@pytest.mark.parametrize("files", [TUNED, HELD], ids=["tuned", "held out"])
def test_what_is_found_is_cheap(files: list[Path]) -> None:
    """Against the cheapest run that meets the target with its finer neighbours, in CPU time."""
    ratios = [
        one.point.cpu / _table(file).cheapest_robust(target)
        for file, target, one, _ in _claims()
        if one.meets and file in files
    ]
    assert np.mean(ratios) <= 1.6
    assert max(ratios) <= 3.0


def test_few_runs_are_made() -> None:
    shares = [len(runs.points) / _table(file).space.count for file, _, _, runs in _claims()]
    assert max(shares) <= 0.4
    assert np.mean(shares) <= 0.3


def test_little_time_is_spent() -> None:
    shares = []
    for file, _, one, runs in _claims():
        whole = sum(point.cpu for point in _table(file).points.values())
        if one.meets:
            shares.append(sum(point.cpu for point in runs.points.values()) / whole)
    assert np.mean(shares) <= 0.2


@pytest.mark.parametrize("file", ALL, ids=lambda file: file.stem)
def test_an_unreachable_target_is_told(file: Path) -> None:
    found = find(runs_of(_table(file)), 1e-7)
    assert not found[0].meets
    assert "add a level" in found[0].reason


@pytest.mark.parametrize("file", ALL, ids=lambda file: file.stem)
def test_brute_force_finds_what_meets_the_target(file: Path) -> None:
    table = _table(file)
    runs = runs_of(table)
    (found,) = find_among_all(runs, 0.1)
    assert len(runs.points) == table.space.count
    if found.meets:
        assert table.error(found.point) <= 0.125


@pytest.mark.parametrize("unstable", [1, 2, 3, 5])
@pytest.mark.parametrize("refined", ["time", "mesh"])
def test_levels_at_which_no_run_is_stable_are_left_out(refined: str, unstable: int) -> None:
    """Where nothing else is refined too: then a line of one level has no run at all."""
    table = _table(ALL[0])
    lines = {"time": Line(), "mesh": Line(), refined: Line(("numerics.dt",), tuple(("",) for _ in range(5)))}
    made = list(table.points.values())[:5]
    spoilt = iter([replace(one, status="failed") for one in made[:unstable]] + made[unstable:])
    runs = Runs(Space(((),), **lines), lambda *_: next(spoilt), runs_of(table).yardstick)
    found = find_among_all(runs, 0.1)
    assert len(runs.points) == 5
    assert all(one.point.stable for one in found)
    assert bool(found) == (unstable < 4)
