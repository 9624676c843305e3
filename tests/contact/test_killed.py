"""Contact that is killed at any moment: resumed from a checkpoint it is the run that nothing disturbed."""

from __future__ import annotations

import json
import random
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_process import Nursery, nursery, wait_until
from contact_decks import crossing, on_floor
from numpy.testing import assert_array_equal

from dismech_cli.output.read import read
from dismech_cli.output.table import read_table

__all__ = ["nursery"]


def rods() -> dict[str, Any]:
    """Two rods that hit, rub and part."""
    deck = crossing(5e-4, 1.0, tolerance=0.05)
    deck["contact"]["friction"] = {"coefficient": 0.3, "slip_speed": 1e-2}
    deck["initial_velocity"][0]["velocity"] = [0.3, 0.2, -1.0]
    return deck


def anchored() -> dict[str, Any]:
    """A rod that is thrown along a floor and sticks: its anchors are part of the state."""
    deck = on_floor(initial_velocity=[{"where": "rod", "velocity": [0.4, 0.0, -0.1]}])
    deck["contact"]["friction"] = {"coefficient": 0.4, "stick": "anchored", "slip_length": 1e-4}
    deck["numerics"] = {"dt": 2.5e-3, "t_end": 0.4}
    deck["output"] = {"every": 2.5e-3}
    return deck


def sheets() -> dict[str, Any]:
    """A free sheet that is thrown on another."""
    deck = rods()
    sheet = {"type": "shell", "material": "m", "thickness": 1e-3}
    deck["geometry"] = [
        sheet
        | {
            "name": name,
            "generate": {
                "shape": "sheet",
                "origin": [0.0, 0.0, height],
                "length": size,
                "width": size,
                "divisions": cuts,
            },
        }
        for name, height, size, cuts in (("low", 0.0, 0.1, 3), ("high", 0.005, 0.06, 2))
    ]
    deck["numerics"] = {"dt": 5e-4, "t_end": 0.02}
    deck["output"] = {"every": 5e-4}
    return deck


@pytest.mark.slow
@pytest.mark.parametrize("make", [rods, anchored, sheets])
def test_killed_and_resumed_is_the_straight_run(nursery: Nursery, tmp_path: Path, make: Any) -> None:
    """Kills fall before, in and after the impact, each in what the last one left."""
    (tmp_path / "deck.yaml").write_text(json.dumps(make()))
    done = nursery.call(tmp_path, "run", "deck.yaml", "-o", "straight")
    assert done.code == 0, done.stderr
    command = ["run", "deck.yaml", "-o", "killed", "--checkpoint-every", "50ms"]
    chance, folder, kills = random.Random(10), tmp_path / "killed", 0
    for _ in range(4):
        process = nursery.start(tmp_path, *command)
        wait_until(lambda: list(folder.glob("checkpoints/*.npz")) or finished(folder))
        time.sleep(chance.uniform(0.0, 0.1))
        process.signal(signal.SIGKILL)
        kills += process.wait().code == -signal.SIGKILL
        command = ["resume", "killed", "--checkpoint-every", "50ms"]
    assert kills
    done = nursery.call(tmp_path, "resume", "killed")
    assert done.code == 0, done.stderr
    with read(folder) as one, read(tmp_path / "straight") as other:
        assert len(one) == len(other) > 1
        assert_array_equal(np.asarray(one.positions), np.asarray(other.positions))
    first, second = (read_table(tmp_path / run / "scalars.csv")[0] for run in ("killed", "straight"))
    for name in first.keys() - {"wall"}:
        assert_array_equal(first[name], second[name], err_msg=name)
    # it did touch, and rub
    assert first["friction"][-1] > 0.0


def finished(folder: Path) -> bool:
    file = folder / "manifest.json"
    return file.exists() and json.loads(file.read_text())["status"] != "running"
