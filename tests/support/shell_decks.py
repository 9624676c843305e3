"""Scenes of shells written by tests, and fixtures that compose, run or refuse them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from shell_cases import Material

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import End
from dismech_cli.session.report import Report
from dismech_cli.session.simulate import simulate

Deck = dict[str, Any]
RUBBER = Material(youngs_modulus=1e6, poisson_ratio=0.3, thickness=2e-3, density=1000.0)
EULER: Deck = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.03}
STATIC: Deck = {"integrator": {"type": "static", "load_steps": 1}}
DOWN: Deck = {"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}
SHEET: Deck = {
    "shape": "sheet",
    "origin": [0.0, 0.0, 0.0],
    "length": 0.3,
    "width": 0.2,
    "divisions": 6,
    "pattern": "alternating",
}
BELL: Deck = {"shape": "hemisphere", "center": [0.0, 0.0, 0.0], "radius": 0.1, "rings": 4}


def shell_deck(surface: Deck = SHEET, *, body: Deck | None = None, **keys: Any) -> Deck:
    """A scene of one shell named ``sheet``; ``body`` is merged into it, ``keys`` into the scene."""
    one: Deck = {"type": "shell", "name": "sheet", "material": "rubber", "thickness": 2e-3}
    rubber = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}
    return {
        "schema_version": 1,
        "name": "shells",
        "materials": {"rubber": rubber},
        "geometry": [one | {"generate": surface} | (body or {})],
        "numerics": EULER,
    } | keys


def rod(start: list[float], end: list[float], name: str = "rod") -> Deck:
    """A rod body of five nodes."""
    return {
        "type": "rod",
        "name": name,
        "material": "rubber",
        "radius": 2e-3,
        "generate": {"shape": "line", "from": start, "to": end, "nodes": 5},
    }


@pytest.fixture
def write(tmp_path: Path) -> Any:
    def written(deck: Deck) -> Path:
        path = tmp_path / "scene.yaml"
        path.write_text(json.dumps(deck, indent=1), encoding="utf-8")
        return path

    return written


@pytest.fixture
def made(write: Any) -> Any:
    return lambda deck: compose(load(write(deck)))


@pytest.fixture
def ran(write: Any) -> Any:
    def done(deck: Deck) -> Report:
        result = simulate(write(deck))
        assert result.outcome.end is End.DONE, result.outcome.message
        return result

    return done


@pytest.fixture
def refused(write: Any) -> Any:
    def message(deck: Deck) -> str:
        with pytest.raises(ScenarioError) as error:
            compose(load(write(deck)))
        return str(error.value)

    return message


MIXED = """\
*Nodes
0, 0, 0
1, 0, 0
0.5, 0.8660254, 0
0, 0, -1
0, 0, -2
*Edges
1, 4
4, 5
*Triangles
1, 2, 3
"""
