"""Feedback in space, at welds and clamps, on hinges, and beside contact."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from control_decks import composed, finished, positions
from decks import Deck
from numpy.testing import assert_allclose

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_mapping

SECTION: Deck = {
    "type": "given",
    "axial_stiffness": 100.0,
    "bending_stiffness_1": 1e-4,
    "bending_stiffness_2": 2e-4,
    "torsional_stiffness": 1.5e-4,
    "mass_per_length": 0.1,
    "rotary_inertia_per_length": 1e-5,
    "radius": 5e-3,
}
STIFF = {
    "curvature_1": "bending_stiffness_1",
    "curvature_2": "bending_stiffness_2",
    "twist": "torsional_stiffness",
    "stretch": "axial_stiffness",
}


def in_space(strain: str, value: Any, section: Deck, **keys: Any) -> Deck:
    """A hanging rod in space with one strain driven."""
    return {
        "schema_version": 1,
        "name": "space",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000}},
        "geometry": [
            {
                "type": "rod",
                "name": "r",
                "material": "m",
                "section": section,
                "bending": "framed",
                "generate": {"shape": "line", "from": [0, 0, 0], "to": [0.1, 0, 0], "nodes": 6},
            }
        ],
        "motions": [{"type": "clamp", "where": "r.start"}],
        "forces": [
            {"type": "gravity", "acceleration": [0, 1.0, -9.81]},
            {"type": "viscous", "coefficient": 1.0},
        ],
        "actuation": [{"type": strain, "rod": "r", "value": value}],
        "numerics": {
            "integrator": {"type": "implicit_euler"},
            "dt": 0.01,
            "t_end": 0.1,
            "newton": {"tolerance": 1e-12},
        },
        "output": {"every": 0.01},
    } | keys


@pytest.mark.parametrize("strain", STIFF)
def test_p_stiffens_one_strain_of_a_framed_rod(strain: str) -> None:
    p, r = 3.0, 0.05 if strain == "stretch" else 2.0
    loop = in_space(strain, {"controlled_by": "c"}, SECTION)
    loop["controllers"] = {"c": {"type": "pi", "feedback": "ideal", "target": r, "gains": {"p": p}}}
    name = STIFF[strain]
    stiff = in_space(strain, r, SECTION | {name: (1.0 + p) * SECTION[name]})
    one, two = (positions(finished(load_mapping(deck))) for deck in (loop, stiff))
    assert_allclose(one, two, atol=1e-11 * 0.1)
    assert np.ptp(one[:, -1], axis=0).max() > 1e-4


@pytest.mark.parametrize("strain", ["curvature_2", "twist"])
def test_sampled_feedback_reaches_a_strain_in_space(strain: str) -> None:
    deck = in_space(strain, {"controlled_by": "c"}, SECTION)
    deck["forces"][1]["coefficient"] = 20.0
    deck["controllers"] = {
        "c": {"type": "pi", "target": 3.0, "gains": {"p": 0.3, "i": 30}, "period": 0.02, "smoothing": 0.02}
    }
    deck["numerics"] |= {"dt": 0.02, "t_end": 2.0, "newton": {}}
    deck["output"] = {"probes": {"off": {"controller": "c", "measure": "error", "over": "max"}}}
    report = finished(load_mapping(deck))
    assert report.probes["off"][0] > 1.0
    assert report.probes["off"][-1] < 0.05 * 3.0


def tee(feedback: Deck) -> Deck:
    """Two rods that meet at a right angle; the first is controlled."""
    deck = in_space("curvature_1", {"controlled_by": "c"}, SECTION)
    deck["geometry"][0]["name"] = "r"
    other = copy.deepcopy(deck["geometry"][0])
    other["name"] = "s"
    other["generate"] = {"shape": "line", "from": [0.1, 0, 0], "to": [0.1, 0.1, 0], "nodes": 6}
    deck["geometry"].append(other)
    deck["joints"] = [{"type": "rigid", "nodes": ["r.end", "s.start"]}]
    deck["controllers"] = {"c": {"type": "pi", "target": 2.0, **feedback}}
    return deck


def test_halves_at_a_joint_follow_the_joint_beside_them() -> None:
    """As they follow a law: a loop that is all feed-forward is an actuation by its target."""
    loop = tee({"gains": {"p": 1e-12}, "period": 0.01, "hold": "step"})
    law = tee({"gains": {"p": 1e-12}, "period": 0.01})
    law["controllers"], law["actuation"][0]["value"] = {}, 2.0
    one, two = (positions(finished(load_mapping(deck))) for deck in (loop, law))
    assert_allclose(one, two, atol=1e-9 * 0.1)


def test_ideal_feedback_is_refused_where_joints_bend_every_way() -> None:
    with pytest.raises(ScenarioError, match="rod 'r' is joined to others"):
        composed(tee({"feedback": "ideal", "gains": {"p": 1.0}}))
    deck = tee({"feedback": "ideal", "gains": {"p": 1.0}})
    deck["actuation"][0]["joints"] = [0, 2]
    composed(deck)


def test_ideal_feedback_is_refused_on_faces() -> None:
    deck: Deck = {
        "schema_version": 1,
        "name": "sheet",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
        "geometry": [
            {
                "type": "shell",
                "name": "s",
                "material": "m",
                "thickness": 1e-3,
                "bending": "midedge",
                "generate": {
                    "shape": "sheet",
                    "origin": [0, 0, 0],
                    "length": 0.1,
                    "width": 0.1,
                    "divisions": 2,
                    "pattern": "alternating",
                },
            }
        ],
        "actuation": [{"type": "dihedral", "shell": "s", "value": {"controlled_by": "c"}}],
        "controllers": {"c": {"type": "pi", "feedback": "ideal", "target": 0.0, "gains": {"p": 1.0}}},
        "numerics": {"dt": 0.01, "t_end": 0.02},
    }
    with pytest.raises(ScenarioError, match="a face of this shell bends every way with one stiffness"):
        composed(deck)


def test_feedback_beside_contact() -> None:
    """Contact keeps its memory in the same state: a rod on a floor bends up at its ends."""
    deck: Deck = {
        "schema_version": 1,
        "name": "floor",
        "dimension": 2,
        "materials": {"m": {"youngs_modulus": 1e7, "poisson_ratio": 0.5, "density": 1000}},
        "geometry": [
            {
                "type": "rod",
                "name": "r",
                "material": "m",
                "radius": 5e-3,
                "generate": {"shape": "line", "from": [0, 0, 5e-3], "to": [0.2, 0, 5e-3], "nodes": 11},
            }
        ],
        "forces": [
            {"type": "gravity", "acceleration": [0, 0, -9.81]},
            {"type": "viscous", "coefficient": 5.0},
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "contact": {"friction": {"coefficient": 0.3, "slip_speed": 1e-3}},
        "actuation": [{"type": "curvature_1", "rod": "r", "value": {"controlled_by": "c"}}],
        "controllers": {
            "c": {
                "type": "pi",
                "target": 3.0,
                "gains": {"p": 0.3, "i": 10},
                "period": 0.02,
                "smoothing": 0.04,
            }
        },
        "numerics": {"dt": 0.01, "t_end": 1.0},
        "output": {
            "probes": {
                "off": {"controller": "c", "measure": "error"},
                "deep": {"contact": ["r", "floor"], "measure": "depth"},
            }
        },
    }
    report = finished(load_mapping(deck))
    names = set(report.state.memory)
    assert any(name.startswith("control.c.") for name in names)
    assert any(not name.startswith("control.") for name in names)
    assert report.probes["off"][-1] < 0.1 * report.probes["off"][0]
    assert report.probes["deep"].max() < 0.1
