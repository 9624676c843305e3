"""Odd scenes: nothing to do, folded, twisted, tiny, split, far away, other units."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, attempt, given_section, line, rod_deck, scalar, solve, tip
from numpy.testing import assert_allclose

from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import End

SILICONE: Deck = {"m": {"youngs_modulus": 2e6, "poisson_ratio": 0.5, "density": 1200.0}}
ROUND: Deck = {"type": "round", "radius": 1e-3}
WEIGHT: Deck = {"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}


def timed(integrator: str, dt: float, t_end: float) -> Deck:
    return {"integrator": {"type": integrator}, "dt": dt, "t_end": t_end}


HELIX: Deck = {
    "shape": "helix",
    "origin": [0.0, 0.0, 0.0],
    "axis": [0.3, 0.2, 1.0],
    "radius": 0.02,
    "pitch": 0.01,
    "turns": 2.3,
    "handedness": "left",
    "nodes": 24,
}


@pytest.mark.parametrize("steps", [50, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("integrator", ["implicit_euler", "generalized_alpha", "tr_bdf2"])
def test_nothing_moves_without_forces(tmp_path: Path, integrator: str, dimension: int, steps: int) -> None:
    deck = rod_deck(
        line(21, [0.1, 0.0, 0.0]) if dimension == 2 else HELIX,
        ROUND,
        materials=SILICONE,
        dimension=dimension,
        numerics=timed(integrator, 1e-3, steps * 1e-3),
        output={"every": steps * 1e-3},
    )
    result = solve(tmp_path, deck)
    moved = result.frames[-1].positions - result.frames[0].positions
    assert_allclose(moved, 0.0, atol=1e-12)


def test_steps_of_any_length_settle_without_forces(tmp_path: Path) -> None:
    for dt in (1e-7, 1e-3, 1.0, 1e3):
        deck = rod_deck(
            HELIX, ROUND, materials=SILICONE, dimension=3, numerics=timed("implicit_euler", dt, 20.0 * dt)
        )
        result = solve(tmp_path, deck)
        assert_allclose(result.frames[-1].positions, result.frames[0].positions, rtol=0, atol=1e-12)


def test_anti_parallel_edges_are_refused_or_named(tmp_path: Path) -> None:
    """A rod folded back on itself has infinite curvature: told before the run, with the place."""
    points = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.0]]
    deck = rod_deck(
        {"shape": "polyline", "points": points}, ROUND, materials=SILICONE, dimension=3, forces=[WEIGHT]
    )
    with pytest.raises(ScenarioError, match="node"):
        attempt(tmp_path, deck)


def test_sharp_kink_bends_like_its_two_beams(tmp_path: Path) -> None:
    """A thousandth short of folded: the back half lies over the front one, its weight on the front's end.

    By w L^4/(E I) (1/8 + 1/3 - 1/4): own weight, that of the back half, and its moment.
    """
    points = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 1e-4]]
    deck = rod_deck(
        {"shape": "polyline", "points": points, "spacing": 0.005},
        ROUND,
        materials={"m": SILICONE["m"] | {"youngs_modulus": 2e9}},
        dimension=3,
        forces=[WEIGHT],
    )
    result = attempt(tmp_path, deck)
    assert result.outcome.end is End.DONE, result.outcome.message
    sag = 4.0 * 1200.0 * 9.81 / (2e9 * 1e-3**2) * 0.1**4 * (1.0 / 8.0 + 1.0 / 3.0 - 1.0 / 4.0)
    # second order in the edge, a twentieth of either half
    assert_allclose(result.frames[-1].positions[20, 2], -sag, rtol=1e-2)


def test_folding_by_force_is_solved(tmp_path: Path) -> None:
    """The far end is led back to the near one: edges turn against each other, however long the steps."""

    def folded(steps: int) -> Deck:
        return rod_deck(
            line(7),
            given_section(axial=1e4),
            motions=[
                {"type": "clamp", "where": "rod.start"},
                {"type": "pin", "where": "rod.end", "displacement": [-1.999, 0.0, 1e-3]},
            ],
            numerics={"integrator": {"type": "static", "load_steps": steps}},
        )

    shapes = [solve(tmp_path, folded(steps)).frames[-1].positions for steps in (20, 40)]
    for shape in shapes:
        assert_allclose(shape[-1], [-0.999, 0.0, 1e-3], rtol=0, atol=1e-12)
    assert_allclose(shapes[1], shapes[0], rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("load_steps", [100, 1000])
def test_a_hundred_turns_of_twist(tmp_path: Path, load_steps: int) -> None:
    """Held straight by tension, the rod takes them evenly: torque GJ phi/L, nothing wraps."""
    turns = 100.0
    angle = 2.0 * np.pi * turns
    deck = rod_deck(
        line(21),
        given_section(axial=1e6, torsion=1e-3),
        dimension=3,
        motions=[
            {"type": "clamp", "where": "rod.start"},
            # far above the tension M^2/(4 EI) that a twisted rod needs to stay straight
            {"type": "clamp", "where": "rod.end", "displacement": [1e-3, 0.0, 0.0], "twist": angle},
        ],
        numerics={"integrator": {"type": "static", "load_steps": load_steps}},
        output={
            "fields": ["twist"],
            "probes": {"middle": {"twist": {"edges": {"of": "rod", "indices": [9, 10]}}}},
        },
    )
    result = solve(tmp_path, deck)
    last = result.frames[-1]
    assert_allclose(last.positions[:, 1:], 0.0, atol=1e-10)
    assert_allclose(last.scalars["middle"], 0.5 * angle, rtol=1e-9)
    assert_allclose(last.scalars["elastic_twist"], 0.5 * 1e-3 * angle**2, rtol=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_single_edge(tmp_path: Path, dimension: int) -> None:
    """A pendulum: pinned, it swings with the period of its two lumped half masses."""
    length = 0.5
    deck = rod_deck(
        line(2, [0.01 * length, 0.0, -length]),
        given_section(axial=1e6),
        dimension=dimension,
        motions=[{"type": "pin", "where": "rod.start"}],
        forces=[WEIGHT],
        numerics=timed("newmark", 5e-3, 3.2),
        output={"every": 5e-3, "probes": {"x": {"position": "rod.end", "component": "x"}}},
    )
    result = solve(tmp_path, deck)
    t, x = np.array([frame.t for frame in result.frames]), scalar(result, "x")
    down = np.flatnonzero((x[:-1] > 0.0) & (x[1:] <= 0.0))
    crossings = t[down] + x[down] / (x[down] - x[down + 1]) * (t[down + 1] - t[down])
    assert_allclose(np.diff(crossings), 2.0 * np.pi * np.sqrt(length / 9.81), rtol=1e-3)


def test_a_single_clamped_edge(tmp_path: Path) -> None:
    """One edge with its joint at the wall, of half an edge: the tip sinks by F l / (2 EI/l) l."""
    force = 1e-4
    deck = rod_deck(
        line(2), given_section(), forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, force]}]
    )
    assert_allclose(tip(solve(tmp_path, deck))[2], 0.5 * force, rtol=1e-6)


def test_two_disjoint_rods_do_not_know_of_each_other(tmp_path: Path) -> None:
    alone = rod_deck(line(21, [0.1, 0.0, 0.0]), ROUND, materials=SILICONE, forces=[WEIGHT])
    rods = [
        alone["geometry"][0]
        | {
            "name": name,
            "generate": {"shape": "line", "from": [x, 0.0, 0.0], "to": [x + 0.1, 0.0, 0.0], "nodes": 21},
        }
        for name, x in (("left", 0.0), ("right", 5.0))
    ]
    both = alone | {
        "geometry": rods,
        "motions": [{"type": "clamp", "where": "left.start"}, {"type": "clamp", "where": "right.start"}],
    }
    expected = solve(tmp_path, alone).frames[-1].positions
    found = solve(tmp_path, both).frames[-1].positions
    assert_allclose(found[:21], expected, rtol=0, atol=1e-9)
    assert_allclose(found[21:] - [5.0, 0.0, 0.0], expected, rtol=0, atol=1e-9)


def heavy(origin: float, numerics: Deck) -> Deck:
    start = [origin, origin, origin]
    return rod_deck(
        {"shape": "line", "from": start, "to": [origin + 0.1, origin, origin], "nodes": 21},
        ROUND,
        materials=SILICONE,
        dimension=3,
        forces=[WEIGHT],
        numerics=numerics,
    )


@pytest.mark.parametrize("offset", [1.0, 1e3, 1e6])
def test_far_from_the_origin(tmp_path: Path, offset: float) -> None:
    """Positions are rounded to 2e-16 of the offset, which turns an edge and with it all that hangs on it."""
    static: Deck = {"integrator": {"type": "static", "load_steps": 5}}
    near = tip(solve(tmp_path, heavy(0.0, static)))
    far = tip(solve(tmp_path, heavy(offset, static))) - offset
    edges = 20
    assert_allclose(far, near, rtol=0, atol=edges * np.finfo(float).eps * offset)


@pytest.mark.parametrize("integrator", ["static", "implicit_euler", "generalized_alpha"])
def test_millimetres_and_grams_give_the_same_motion(tmp_path: Path, integrator: str) -> None:
    """The same scene with all numbers in mm, g and s: no absolute tolerance may tell them apart."""

    def scene(length: float, mass: float) -> Deck:
        """One metre is ``length`` and one kilogram ``mass`` in the new units."""
        pressure = mass / length
        numerics: Deck = (
            {"integrator": {"type": "static", "load_steps": 5}}
            if integrator == "static"
            else timed(integrator, 5e-3, 0.15)
        )
        material = {
            "youngs_modulus": 2e6 * pressure,
            "poisson_ratio": 0.5,
            "density": 1200.0 * mass / length**3,
        }
        return rod_deck(
            HELIX | {"radius": 0.02 * length, "pitch": 0.01 * length},
            {"type": "round", "radius": 1e-3 * length},
            dimension=3,
            materials={"m": material},
            forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -1.0 * length]}],
            numerics=numerics | {"newton": {"tolerance": 1e-11}},
        )

    metres = solve(tmp_path, scene(1.0, 1.0))
    millimetres = solve(tmp_path, scene(1e3, 1e3))
    assert_allclose(
        millimetres.frames[-1].positions / 1e3, metres.frames[-1].positions, rtol=0, atol=1e-9 * 0.02
    )


def test_edges_thicker_than_long(tmp_path: Path) -> None:
    """A mesh finer than the rod is thick is nothing special."""
    deck = rod_deck(
        line(101, [0.02, 0.0, 0.0]), {"type": "round", "radius": 1e-3}, materials=SILICONE, forces=[WEIGHT]
    )
    weight_per_length = 1200.0 * np.pi * 1e-6 * 9.81
    stiffness = 2e6 * np.pi * 1e-12 / 4.0
    assert_allclose(
        tip(solve(tmp_path, deck))[2], -weight_per_length * 0.02**4 / (8.0 * stiffness), rtol=2e-3
    )


@pytest.mark.parametrize("twist", [0.0, 1.0])
def test_a_rod_held_everywhere(tmp_path: Path, twist: float) -> None:
    """No free position at all."""
    deck = rod_deck(
        line(5), dimension=3, motions=[{"type": "clamp", "where": "rod", "twist": twist}], forces=[WEIGHT]
    )
    result: Any = solve(tmp_path, deck)
    assert_allclose(result.frames[-1].positions, result.frames[0].positions, rtol=0, atol=0)
