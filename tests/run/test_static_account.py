"""Statics has no speed: nothing dissipates, and no balance counts as a motion that blew up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import attempt, given_section, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose, assert_array_equal
from shell_decks import Deck, made, ran, shell_deck, write

from dismech_cli.run.loop import End

__all__ = ["made", "ran", "write"]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("nodes", [3, 11, 24])
def test_free_actuation_ends_well_whatever_rounding_leaves(
    tmp_path: Path, nodes: int, dimension: int
) -> None:
    """The work of the actuators cancels exactly where nothing resists: the rest is round-off."""
    for steps in range(1, 9):
        for value in (0.3, 5.0):
            numerics = {"integrator": {"type": "static", "load_steps": steps}}
            actuation = [{"type": "curvature_1", "rod": "rod", "value": value}]
            deck = rod_deck(line(nodes), dimension=dimension, actuation=actuation, numerics=numerics)
            outcome = attempt(tmp_path, deck).outcome
            assert outcome.end is End.DONE, outcome.message


@pytest.mark.parametrize("bending", ["hinge", "midedge", "averaged"])
def test_free_folds_end_well_at_every_angle(ran: Any, bending: str) -> None:
    fold = {"plane": {"point": [0.1, 0, 0], "normal": [1, 0, 0], "within": 1e-3}}
    surface = {"shape": "sheet", "origin": [0, 0, 0], "length": 0.2, "width": 0.1, "divisions": 2}
    surface["pattern"] = "right"
    for degrees in (10, 20, 60, 90, 120, 150):
        ramp = {"ramp": {"from": 0.0, "to": np.radians(degrees), "end": 1.0}}
        deck: Deck = shell_deck(
            surface,
            body={"bending": bending},
            motions=[{"type": "pin", "where": {"box": {"min": [0, 0, 0], "max": [0.1, 0.1, 0]}}}],
            actuation=[{"type": "dihedral", "shell": "sheet", "hinges": fold, "value": ramp}],
            numerics={"integrator": {"type": "static", "load_steps": 10}},
        )
        end = ran(deck).frames[-1].positions[:, 0].max()
        assert_allclose(end, 0.1 + 0.1 * max(np.cos(np.radians(degrees)), 0.0), atol=1e-6)


def test_drag_takes_nothing_out_of_statics(tmp_path: Path) -> None:
    force = {"type": "point", "where": "rod.end", "force": [0.0, 0.0, -0.1]}
    drag = {"type": "viscous", "coefficient": 1000.0}
    still, dragged = (
        solve(tmp_path, rod_deck(line(21), given_section(), forces=forces))
        for forces in ([force], [force, drag])
    )
    assert_array_equal(dragged.frames[-1].positions, still.frames[-1].positions)
    assert_array_equal(scalar(dragged, "dissipation"), 0.0)
    assert_array_equal(scalar(dragged, "error"), scalar(still, "error"))
