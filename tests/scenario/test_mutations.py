"""Whatever is wrong with a scenario is told with its place, soon; nothing breaks and nothing hangs."""

from __future__ import annotations

import re

import numpy as np
import pytest
from mutations import mutated
from time_limit import within

from dismech_cli.compose import sizes
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_text
from dismech_cli.session.inspect import estimate

PLACE = re.compile(r":\d+:\d+: ")
LIMIT = 5.0  # [s] of processor time


def _fault(seed: int) -> str:
    """What is wrong with a mutated scenario, or nothing."""
    deck, text = mutated(seed)
    format = "toml" if deck.suffix == ".toml" else "yaml"
    with within(LIMIT), np.errstate(all="ignore"):
        try:
            loaded = load_text(text, directory=deck.parent, format=format)
            estimate(compose(loaded, kernels="numpy"), loaded.scenario.numerics)
        except ScenarioError as error:
            return str(error)
    return ""


def _check(seeds: range, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(sizes, "machine_memory", lambda: 5e8)
    found = 0
    for seed in seeds:
        message = _fault(seed)
        found += bool(message)
        if message:
            assert PLACE.search(message.splitlines()[0]), (seed, message)
    return found


def test_mutated_scenarios_are_run_or_refused_with_a_place(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _check(range(150), monkeypatch) > 40


@pytest.mark.slow
def test_many_mutated_scenarios_are_run_or_refused_with_a_place(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _check(range(120, 2120), monkeypatch) > 700
