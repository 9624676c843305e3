"""How much a line through nodes is bent, as markers on a body show it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from cli_call import call
from decks import Deck

__all__ = ["call"]

TURN = 0.3  # of each of ten joints [rad]


def zigzag(turns: list[float]) -> np.ndarray:
    """Nodes of a line in the xz-plane whose edges of 10 mm turn so, shape (N, 3)."""
    angle = np.concatenate(([0.0], np.cumsum(turns)))
    steps = 0.01 * np.column_stack((np.cos(angle), np.zeros(len(angle)), np.sin(angle)))
    return np.concatenate((np.zeros((1, 3)), np.cumsum(steps, axis=0)))


def deck(nodes: list[int], turns: list[float], about: list[float]) -> Deck:
    np.savetxt("line.csv", zigzag(turns), delimiter=",", header="x,y,z", comments="")
    rod = {"type": "rod", "name": "arm", "material": "m", "radius": 1e-3}
    return {
        "schema_version": 1,
        "name": "bent",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000}},
        "geometry": [rod | {"generate": {"shape": "csv", "file": "line.csv"}}],
        "motions": [{"type": "clamp", "where": "arm.start"}],
        "numerics": {"integrator": {"type": "static", "load_steps": 1}},
        "expect": {
            "bend": {
                "probe": {"bend": "arm", "nodes": nodes, "about": about},
                "value": 0,
                "tolerance": 1e9,
                "source": "none",
            }
        },
    }


@pytest.mark.parametrize("every", [1, 2, 5])
def test_it_is_the_mean_of_what_each_joint_turns(call, every):
    """Chords of arcs turn by as much as all joints from the middle of one to that of the next."""
    scene = deck(list(range(0, 11, every)), 10 * [TURN], [0, -2, 0])
    Path("scene.yaml").write_text(json.dumps(scene))
    (found,) = json.loads(call("run", "scene.yaml", "-o", "out", "--json", "-q").stdout)["expectations"]
    assert found["measured"] == pytest.approx(2.0 * np.tan(0.5 * every * TURN), rel=1e-6)


def test_turns_one_way_and_the_other_cancel(call):
    Path("scene.yaml").write_text(json.dumps(deck([0, 1, 2, 3], [0.2, -0.2], [0, -1, 0])))
    (found,) = json.loads(call("run", "scene.yaml", "-o", "out", "--json", "-q").stdout)["expectations"]
    assert abs(found["measured"]) < 1e-6


@pytest.mark.parametrize(
    ("nodes", "body", "words"),
    [
        ([0, 3, 3], "arm", "3 follows 3"),
        ([0, 1, 20], "arm", "'arm' has 12 nodes, counted from 0; there is no 20"),
        ([0, 1, 2], "am", "did you mean 'arm'"),
        ([0, 1], "arm", "nodes"),
    ],
)
def test_what_is_no_line_is_refused(call, nodes, body, words):
    scene = deck(nodes, 10 * [TURN], [0, -1, 0])
    scene["expect"]["bend"]["probe"]["bend"] = body
    Path("scene.yaml").write_text(json.dumps(scene))
    done = call("check", "scene.yaml")
    assert done.code == 2
    assert words in done.stderr
