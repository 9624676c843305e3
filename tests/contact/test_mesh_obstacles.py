"""Mesh obstacles in runs: closed forms, moving ones, what is refused and told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from contact_decks import MASS, on_floor
from numpy.testing import assert_allclose

from dismech_cli import simulate
from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import Limits

BOX = """*Nodes
0, 0, 0
1, 0, 0
1, 1, 0
0, 1, 0
0, 0, 1
1, 0, 1
1, 1, 1
0, 1, 1
*Triangles
1, 3, 2
1, 4, 3
5, 6, 7
5, 7, 8
1, 2, 6
1, 6, 5
2, 3, 7
2, 7, 6
3, 4, 8
3, 8, 7
4, 1, 5
4, 5, 8
"""
# a table whose top is at z = 0
TABLE = {"scale": 10.0, "move": [-4.5, -5.0, -10.0]}


@pytest.fixture(autouse=True)
def _beside_the_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("box.txt").write_text(BOX)


def on_mesh(force: float = 0.0, **obstacle: Any) -> dict[str, Any]:
    """The rod of a kilogram on a large box of twelve triangles in place of the floor."""
    deck = on_floor(force, dimension=3)
    floor = {"name": "floor", "type": "mesh", "mesh": {"file": "box.txt", **TABLE}}
    deck["obstacles"] = [floor | {"solid": True} | obstacle]
    return deck


@pytest.mark.slow
@pytest.mark.parametrize("force", [5.0, 10.5])
def test_friction_on_a_mesh_is_that_on_a_plane(force: float) -> None:
    """The diagonal of the top is not felt: the rod slides over it."""
    report = simulate(on_mesh(force))
    expected = (force - 0.4 * MASS * 9.8) ** 2 / (2.0 * MASS)
    assert_allclose(report.scalars["kinetic"][-1], expected, rtol=0.02)
    assert report.warnings == ()


@pytest.mark.slow
def test_a_turning_mesh_takes_the_rod_along_and_its_reaction_is_the_weight() -> None:
    turn = {"axis": [0, 0, 1], "about": [0.5, 0, 0], "angle": {"ramp": {"from": 0, "to": 0.5, "end": 1.0}}}
    deck = on_mesh(motion=turn)
    deck["numerics"]["integrator"] = {"type": "implicit_euler"}
    deck["output"]["probes"] = {
        "load": {"contact": ["rod", "floor"], "measure": "load"},
        "up": {"contact": ["rod", "floor"], "measure": "force", "component": "z"},
        "end": {"velocity": "rod.end", "component": "magnitude"},
    }
    report = simulate(deck)
    assert_allclose(report.scalars["load"][-1], MASS * 9.8, rtol=1e-3)
    assert_allclose(report.scalars["up"][-1], MASS * 9.8, rtol=1e-3)
    # the end is half a metre from the axis; where all sticks it goes as fast as the table
    assert_allclose(report.scalars["end"][-2], 0.5 * 0.5, rtol=1e-2)
    assert report.warnings == ()


@pytest.mark.parametrize("dt", [1e-1, 1e-2])
def test_nothing_falls_through_a_thin_mesh(dt: float) -> None:
    """An open surface of no thickness is touched from either side, at fifty radii a step."""
    deck = on_mesh(solid=False)
    deck["obstacles"][0] = {
        "name": "floor",
        "type": "mesh",
        "generate": {
            "shape": "sheet",
            "origin": [-1.0, -1.0, -0.5],
            "length": 3.0,
            "width": 2.0,
            "divisions": 2,
        },
    }
    deck["contact"] = {"law": {"tolerance": 0.05}}
    deck["forces"] = []
    deck["initial_velocity"] = [{"where": "rod", "velocity": [0.0, 0.0, -50 * 0.025 / dt]}]
    deck["numerics"] = {"dt": dt, "t_end": 3 * dt}
    deck["output"] = {"every": dt, "probes": {"z": {"position": "rod", "component": "z"}}}
    report = simulate(deck)
    if report.exit == 0:
        assert (report.scalars["z"] > -0.5).all()
    else:
        assert report.exit == 3
        assert report.message
    assert not any("passes through" in line for line in report.warnings)


def begun(deck: dict[str, Any]) -> tuple[str, ...]:
    return simulate(deck, limits=Limits(until=0.0)).warnings


def test_what_starts_inside_is_told() -> None:
    deck = on_mesh()
    deck["geometry"][0]["generate"] |= {"from": [0, 0, -1.0], "to": [1.0, 0, -1.0]}
    assert any("'rod' starts inside of 'floor'" in line for line in begun(deck))
    deck["obstacles"][0]["solid"] = False
    assert not any("inside" in line for line in begun(deck))


@pytest.mark.slow
def test_what_starts_through_is_told_at_the_start_and_after_the_run() -> None:
    deck = on_mesh()
    deck["geometry"][0]["generate"] |= {"from": [0, 0, -0.5], "to": [0.1, 0, 0.5], "nodes": 4}
    deck["numerics"]["t_end"] = 0.1
    deck["forces"] = []
    warnings = simulate(deck).warnings
    assert any("'rod' starts through 'floor'" in line for line in warnings)
    assert any("an edge passes through a triangle of 'floor'" in line for line in warnings)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mesh": {"file": "nowhere.obj"}}, r"obstacles\[0\].mesh.*nowhere.obj"),
        ({"mesh": None}, "generate.*mesh|mesh.*generate"),
        (
            {"mesh": None, "generate": {"shape": "disc", "center": [0, 0, 0], "radius": 1.0, "rings": 2}},
            r"obstacles\[0\].solid: the surface is not closed: 12 of its edges are rims",
        ),
        ({"thickness": -1.0}, "thickness"),
    ],
)
def test_refused(change: dict[str, Any], message: str) -> None:
    deck = on_mesh()
    deck["obstacles"][0] |= change
    deck["obstacles"][0] = {key: value for key, value in deck["obstacles"][0].items() if value is not None}
    with pytest.raises(ScenarioError, match=message):
        begun(deck)


def test_a_corner_that_comes_through_a_triangle_is_told() -> None:
    """Shells touch obstacles by their edges: what passes between these pushes nothing."""
    deck = on_mesh()
    shape = {"shape": "sheet", "origin": [0, 0, 0], "length": 1, "width": 1, "divisions": 1}
    deck["geometry"] = [
        {"type": "shell", "name": "sheet", "material": "m", "thickness": 0.01, "generate": shape}
    ]
    rising = {"displacement": [0, 0, {"ramp": {"from": 0, "to": 0.2, "end": 0.1}}]}
    box = {"file": "box.txt", "scale": 0.05, "move": [0.7, 0.2, -0.1]}
    deck["obstacles"] = [{"name": "box", "type": "mesh", "mesh": box, "solid": True, "motion": rising}]
    deck["contact"] = {"pairs": [{"between": ["sheet", "box"]}]}
    deck["motions"] = [{"type": "pin", "where": {"nodes": {"of": "sheet", "indices": [0, 1, 2]}}}]
    deck["forces"] = []
    deck["numerics"] = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.1}
    deck["output"] = {"every": 0.02}
    (warning,) = simulate(deck).warnings
    assert "a triangle of a shell is pierced by 8 edges of 'box' at t = 0.04 s" in warning
