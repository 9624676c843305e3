"""Runs in which shells touch: momentum, tunnelling, what is told, and resuming bit by bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli.contact.crossing import crossings
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed

LOWER, UPPER = 0.0, 0.005


def sheets(dt: float, speed: float, steps: int, **changes: Any) -> dict[str, Any]:
    """Two free sheets of a millimetre, the upper one on its way down."""

    def sheet(name: str, size: float, height: float, divisions: int) -> dict[str, Any]:
        return {
            "type": "shell",
            "name": name,
            "material": "m",
            "thickness": 1e-3,
            "generate": {
                "shape": "sheet",
                "origin": [-0.4 * size, -0.5 * size, height],
                "length": size,
                "width": size,
                "divisions": divisions,
            },
        }

    deck: dict[str, Any] = {
        "schema_version": 1,
        "name": "sheets",
        "materials": {"m": {"youngs_modulus": 1e7, "poisson_ratio": 0.3, "density": 1000}},
        "geometry": [sheet("low", 0.1, LOWER, 3), sheet("high", 0.06, UPPER, 2)],
        "contact": {},
        "initial_velocity": [{"where": "high", "velocity": [0.2 * speed, 0.0, -speed]}],
        "numerics": {"dt": dt, "t_end": steps * dt},
        "output": {"every": dt},
    }
    return deck | changes


@pytest.mark.slow
@pytest.mark.parametrize("friction", [{}, {"friction": {"coefficient": 0.4}}])
def test_momentum_passes_from_one_to_the_other(friction: dict[str, Any]) -> None:
    deck = sheets(1e-3, 1.0, 12, contact=friction)
    report = dismech_cli.simulate(deck)
    state, model = report.outcome.state, report.composition.simulation.model
    momentum = (model.mass * state.v)[: model.dofs.n_positions].reshape(-1, 3)
    total = 0.06**2
    assert_allclose(momentum.sum(axis=0), [0.2 * total, 0.0, -total], atol=1e-10 * total)
    low = momentum[model.dofs.space_positions(model.rest)[:, 2] == LOWER].sum(axis=0)
    assert low[2] < -0.2 * total
    assert (low[0] > 0.01 * total) == bool(friction)


@pytest.mark.slow
@pytest.mark.parametrize("dt", [1e-2, 1e-3])
def test_nothing_tunnels_at_fifty_thicknesses_a_step(dt: float) -> None:
    """Caught, or the run fails and says so: never through in silence."""
    report = dismech_cli.simulate(sheets(dt, 0.05 / dt, 4))
    assert report.exit in (0, 3)
    model = report.composition.simulation.model
    x = model.dofs.space_positions(report.outcome.state.q)
    (contact,) = model.changing
    assert contact.faces is not None
    triangles = contact.faces.surface.nodes
    sides = np.concatenate((triangles[:, :2], triangles[:, 1:], triangles[:, ::2]))
    assert not len(crossings(x, sides, triangles))
    low = model.dofs.space_positions(model.rest)[:, 2] == LOWER
    assert x[low, 2].mean() < x[~low, 2].mean()


def test_a_rod_that_starts_through_a_sheet_is_told(tmp_path: Path) -> None:
    deck = sheets(1e-3, 0.0, 1)
    deck["geometry"][1] = {
        "type": "rod",
        "name": "needle",
        "material": "m",
        "radius": 1e-3,
        "generate": {"shape": "line", "from": [0.011, 0.003, -0.01], "to": [0.012, 0.004, 0.02], "nodes": 3},
    }
    del deck["initial_velocity"]
    deck["motions"] = [
        {"type": "clamp", "where": "low"},
        {"type": "pin", "where": "needle.start"},
        {"type": "pin", "where": "needle.end"},
    ]
    # the start is told, whatever comes of it
    deck["numerics"] |= {"dt": 1e-5, "t_end": 1e-5}
    deck["output"] = {"every": 1e-5}
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(deck))
    told = "\n".join(dismech_cli.simulate(file).warnings)
    assert "'low' starts through 'needle'" in told
    assert "an edge of 'low' or 'needle' passes through a triangle" in told


def test_shells_whose_thickness_varies_touch() -> None:
    deck = sheets(1e-3, 1.0, 4)
    deck["geometry"][0]["thickness"] = {"expression": "0.001 + 0.001*x"}
    report = dismech_cli.simulate(deck)
    assert report.exit == 0
    assert 0.0 < report.outcome.state.memory["contact.worst"][0] <= 0.05
    assert report.warnings == ()


def test_a_resumed_run_is_the_straight_run(tmp_path: Path) -> None:
    """Through the raise of the stiffness and the pairs that come: stopped before, within and after."""
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(sheets(1e-3, 1.0, 8)))

    def table(folder: Path) -> np.ndarray:
        rows = [line.split(",") for line in (folder / "scalars.csv").read_text().splitlines()]
        keep = [i for i, name in enumerate(rows[0]) if not name.startswith("wall")]
        return np.array([[float(row[i]) for i in keep] for row in rows[1:]])

    dismech_cli.simulate(file, out=tmp_path / "straight")
    dismech_cli.simulate(file, limits=Limits(until=0.003), out=tmp_path / "run")
    for until in ("0.005 s", "0.007 s", None):
        assert proceed(tmp_path / "run", Pause(until, None, 60.0), Silent(), ()).record.ending.code == 0
    assert_array_equal(table(tmp_path / "run"), table(tmp_path / "straight"))
