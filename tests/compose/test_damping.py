"""Material damping in the model: where it is asked for, and nowhere else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import STATIC, Deck, line, rod_deck
from numpy.testing import assert_allclose
from shell_decks import SHEET, rod, shell_deck

from dismech_cli import load
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.compose.structure.plan import Bending
from dismech_cli.errors import ScenarioError
from dismech_cli.model.rate import ViscousStress

TIMED: Deck = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.02}
ROUND: Deck = {"type": "round", "radius": 1e-2}


def composed(folder: Path, deck: Deck) -> Composition:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return compose(load(file))


def rod_of(time: Any, **keys: Any) -> Deck:
    materials = {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3, "relaxation_time": time}}
    return rod_deck(line(5), ROUND, **{"materials": materials, "numerics": TIMED} | keys)


def stresses(made: Composition) -> dict[str, ViscousStress]:
    return {term.name: term for term in made.simulation.model.terms if isinstance(term, ViscousStress)}


def test_none_without_a_relaxation_time(tmp_path: Path) -> None:
    assert not stresses(composed(tmp_path, rod_of(0.0)))
    made = composed(tmp_path, rod_of(0.0, dimension=3))
    assert made.plan.bending is Bending.ISOTROPIC


def test_statics_know_none_and_say_so(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(rod_of("10 ms", dimension=3, numerics=STATIC)), encoding="utf-8")
    loaded = load(file)
    assert any("relaxation_time" in warning and "static" in warning for warning in loaded.warnings)
    made = compose(loaded)
    assert not stresses(made)
    assert made.plan.bending is Bending.ISOTROPIC


def test_rods_in_space_are_framed(tmp_path: Path) -> None:
    made = composed(tmp_path, rod_of("10 ms", dimension=3))
    assert made.plan.bending is Bending.FRAMED
    assert any("damps curvature" in decision.why for decision in made.plan.decisions)
    found = stresses(made)
    assert set(found) == {"stretch damping", "bending and twist damping"}
    assert set(found) <= set(made.simulation.roles.dissipative)
    with pytest.raises(ScenarioError, match="isotropic bending is not exact here"):
        composed(tmp_path, rod_of("10 ms", dimension=3, rod={"bending": "isotropic"}))


def test_a_negative_time_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"relaxation_time: must be at least 0"):
        composed(tmp_path, rod_of("-1 ms"))


def test_only_the_rod_that_asks(tmp_path: Path) -> None:
    """Of two welded rods one damps: its edges and joints do, and half of the joint between them."""
    deck = rod_of("10 ms", rod={"name": "one"}, motions=[])
    second = deck["geometry"][0] | {"name": "two", "material": "plain"}
    second["generate"] = line(5, (2.0, 0.0, 0.0)) | {"from": [1.0, 0.0, 0.0]}
    deck["geometry"].append(second)
    deck["materials"]["plain"] = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3}
    deck["joints"] = [{"type": "rigid", "nodes": ["one.end", "two.start"]}]
    found = stresses(composed(tmp_path, deck))
    assert len(found["stretch damping"].dofs) == 4
    tau = found["bending damping"].parameters[-1]
    assert_allclose(np.sort(tau), [5e-3, 1e-2, 1e-2, 1e-2], rtol=1e-14)


def test_welds_to_shells_damp_nothing_and_check_says_so(tmp_path: Path) -> None:
    deck = shell_deck(
        geometry=[
            {"type": "shell", "name": "sheet", "material": "rubber", "thickness": 2e-3, "generate": SHEET},
            rod([0.0, 0.0, 0.0], [0.0, 0.0, 0.1], "leg"),
        ],
        joints=[{"type": "rigid", "nodes": ["leg.start", {"nearest": [0.0, 0.0, 0.0]}]}],
        numerics=TIMED,
    )
    for material in deck["materials"].values():
        material["relaxation_time"] = "10 ms"
    made = composed(tmp_path, deck)
    assert {"sheet.membrane damping", "sheet.bending damping", "stretch damping"} <= set(stresses(made))
    assert "no damping in welds of rods to shells" in [decision.what for decision in made.plan.decisions]
