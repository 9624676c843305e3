"""Whatever is wrong with a scenario is told with its place, soon; nothing breaks and nothing hangs."""

from __future__ import annotations

from pathlib import Path

import pytest
from mutation_run import take_deck, taken


def _check(seeds: range, folder: Path) -> int:
    """Number of scenarios that are refused."""
    found = [taken(take_deck, seed, folder) for seed in seeds]
    assert [one.fault for one in found if one.fault] == []
    return sum(bool(one.refused) for one in found)


def test_mutated_scenarios_are_run_or_refused_with_a_place(tmp_path: Path) -> None:
    assert _check(range(150), tmp_path) > 40


@pytest.mark.slow
def test_many_mutated_scenarios_are_run_or_refused_with_a_place(tmp_path: Path) -> None:
    assert _check(range(120, 2120), tmp_path) > 700
