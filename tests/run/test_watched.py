"""Watched probes are read after every step, one of several names once."""

from __future__ import annotations

from typing import Any

import numpy as np
from decks import line, rod_deck
from shell_decks import made, write

from dismech_cli.model.saved import restore_all, save_all
from dismech_cli.run.watched import Watched

__all__ = ["made", "write"]


class Counting:
    """A probe that tells how often it was read."""

    unit = "1"

    def __init__(self) -> None:
        self.read = 0

    def __call__(self, s: Any) -> float:
        self.read += 1
        return float(self.read)


def snapshot(t: float) -> Any:
    return type("Shown", (), {"state": type("Time", (), {"t": t})})


def test_one_of_several_names_is_read_once_and_resumed_under_all() -> None:
    shared, other = Counting(), Counting()
    probes: Any = {"mean": shared, "swing": shared, "other": other}
    watched = Watched(probes)
    watched.read(snapshot(0.0))
    watched = restore_all({"w": Watched(probes)}, *save_all({"w": watched}))["w"]  # type: ignore[assignment]
    watched.read(snapshot(1.0))
    assert shared.read == other.read == 2
    read = {name: values.tolist() for name, values in watched.values.items()}
    assert read == {name: [1.0, 2.0] for name in probes}


def test_expectations_of_the_same_probe_share_it(made: Any) -> None:
    tip = {"displacement": "rod.end", "component": "y"}
    expect = {
        "last": {"probe": tip, "value": 0.0, "tolerance": 1.0, "source": "none"},
        "span": {"probe": tip, "reduce": "span", "value": 0.0, "tolerance": 1.0, "source": "none"},
        "aside": {"probe": tip | {"component": "x"}, "value": 0.0, "tolerance": 1.0, "source": "none"},
    }
    watched = made(rod_deck(line(5), expect=expect)).simulation.watched
    assert watched["last"] is watched["span"] is not watched["aside"]


def test_the_mean_of_one_node_is_that_node(made: Any) -> None:
    one = {"position": {"nodes": {"of": "rod", "range": [3, 3]}}, "component": "x"}
    simulation = made(rod_deck(line(5), output={"every": 1.0, "probes": {"one": one}})).simulation
    shown: Any = type("Shown", (), {"positions": np.arange(18.0).reshape(6, 3) ** 0.5})
    assert simulation.probes["one"](shown) == shown.positions[[3]].mean(axis=0)[0]
