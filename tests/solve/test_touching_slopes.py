"""Derivatives of runs in which things touch, smooth and rough, with the stiffness that they are given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slope_cases import CLAMP, DOWN, STATIC, Case, Deck, arm, central, differentiated, dynamics, scene

from dismech_cli.contact.contact import WORST
from dismech_cli.kernels.linearization import Linearization
from dismech_cli.solve.adjoint import Owed, adjoint
from dismech_cli.solve.anew import Anew
from dismech_cli.solve.pattern import SparsityPattern
from dismech_cli.solve.sensitivity import forward
from dismech_cli.solve.trials import at

E = ("materials.rubber.youngs_modulus", 1e6)
RADIUS, DENSITY = ("geometry[0].radius", 5e-3), ("materials.rubber.density", 1000.0)
KAPPA = ("contact.law.stiffness", 3e3)
MU, SLIP = ("contact.friction.coefficient", 0.4), ("contact.friction.slip_speed", 0.02)
FLOOR = ("obstacles[0].point[2]", -0.008)
ROUGH: Deck = {"coefficient": 0.4, "slip_speed": 0.02}


def on_floor(numerics: Deck, rough: Deck | None = None) -> Deck:
    """An arm that falls on a floor and is pulled along it."""
    floor: Deck = {"type": "plane", "name": "floor", "point": [0, 0, FLOOR[1]], "normal": [0, 0, 1]}
    aside: Deck = {"type": "point", "where": "arm.end", "force": [0, 0.03, 0]}
    drag: Deck = {"type": "viscous", "coefficient": 0.3}
    still = numerics is STATIC
    touch: Deck = {"pairs": [{"between": ["arm", "floor"]}], "law": {"stiffness": KAPPA[1]}}
    return scene(
        forces=[DOWN, aside] if still else [DOWN, aside, drag],
        obstacles=[floor],
        contact=touch | ({} if rough is None else {"friction": rough}),
        numerics=numerics,
    )


def crossed(numerics: Deck, rough: Deck | None = None) -> Deck:
    """An arm that falls across another."""
    under = arm(
        name="bar",
        generate={"shape": "line", "from": [0.2, -0.1, -0.014], "to": [0.21, 0.1, -0.014], "nodes": 6},
    )
    holds: list[Deck] = [
        CLAMP,
        {"type": "clamp", "where": "bar.start"},
        {"type": "clamp", "where": "bar.end"},
    ]
    touch: Deck = {"pairs": [{"between": ["arm", "bar"]}], "law": {"stiffness": KAPPA[1]}}
    aside: Deck = {"type": "point", "where": "arm.end", "force": [0, 0.01, 0]}
    drag: Deck = {"type": "viscous", "coefficient": 0.3}
    return scene(
        geometry=[arm(), under],
        motions=holds,
        forces=[DOWN, aside, drag],
        contact=touch | ({} if rough is None else {"friction": rough}),
        numerics=numerics,
    )


LONG = dynamics("implicit_euler", 0.01, 10)
ALPHA, TR = dynamics("generalized_alpha", 0.01, 10), dynamics("tr_bdf2", 0.01, 8)
CASES = {
    "floor, smooth, static": (on_floor(STATIC), [E, KAPPA, FLOOR]),
    "floor, smooth": (on_floor(ALPHA), [E, KAPPA, FLOOR, RADIUS, DENSITY]),
    "floor, rough": (on_floor(LONG, ROUGH), [E, KAPPA, MU, SLIP]),
    "floor, rough, from an acceleration": (on_floor(ALPHA, ROUGH), [MU, E]),
    "floor, rough, stages": (on_floor(TR, ROUGH), [MU, KAPPA]),
    "floor, rough, its tangent symmetric": (on_floor(LONG, ROUGH | {"tangent": "symmetric"}), [MU]),
    "crossed, smooth": (crossed(ALPHA), [E, KAPPA, RADIUS]),
    "crossed, rough": (crossed(LONG, ROUGH), [MU]),
    "crossed, rough, more": (crossed(LONG, ROUGH), [KAPPA, E]),
}


QUICK = ("floor, smooth, static", "floor, rough, from an acceleration", "crossed, rough")


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in CASES]
)
def test_the_derivative_is_that_of_the_run(name: str) -> None:
    deck, where = CASES[name]
    cases = [Case(deck, *one) for one in where]
    simulation, steps = cases[0].taped()
    assert steps[-1].result.state.memory[WORST][0] > 0.01  # something touched
    model = differentiated(cases, simulation, steps)
    *_, d = forward(model, simulation.start, steps)
    # small enough for no edge to touch a step earlier
    parts = np.array([1e-3, 5e-4])
    for k, case in enumerate(cases):
        size = np.abs(d.q[:, k]).max()
        errors = np.array([np.abs(central(case, part) - d.q[:, k]).max() / size for part in parts])
        slope = np.polyfit(np.log(parts), np.log(errors), 1)[0]
        assert slope == pytest.approx(2.0, abs=0.1) or errors.max() < 1e-7, (case.path, errors, slope)
    rng = np.random.default_rng(0)
    by_q, by_v = rng.normal(size=(2, len(simulation.start.q)))
    turns = tuple(rng.normal(size=len(edges.angles)) for edges in model.edges)
    direct = by_q @ d.q + by_v @ d.v + sum(x @ y for x, y in zip(turns, d.turns, strict=True))
    owed = Owed(by_q.copy(), by_v.copy(), np.zeros_like(by_q), turns)
    assert_allclose(adjoint(model, simulation.start, steps, owed), direct, rtol=1e-9)


SOLIDS: list[Deck] = [
    {"type": "plane", "point": [0, 0, -0.008], "normal": [0, 0, 1]},
    {"type": "cylinder", "point": [0.1, 0, -0.03], "axis": [0, 1, 0], "radius": 0.025},
    {"type": "sphere", "center": [0.12, 0, -0.03], "radius": 0.025},
]


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda solid: str(solid["type"]))
def test_friction_has_the_slope_that_it_has_where_lines_touch_in_part(solid: Deck) -> None:
    """Edges at all heights and angles, some of them partly in a solid: points of contact move along them."""
    deck = on_floor(LONG, ROUGH) | {"obstacles": [solid | {"name": "floor"}]}
    simulation = Case(deck, *E).simulation()
    model, start, rng = simulation.model, simulation.start, np.random.default_rng(3)
    q, v, count = start.q.copy(), np.zeros_like(start.q), model.dofs.n_positions
    q[2:count:3] += -0.003 + 0.004 * rng.normal(size=count // 3)
    v[:count] = 0.02 * rng.normal(size=count)
    c = at(model, replace(start, q=q, v=v))
    anew = Anew([term.exactly() for term in model.changing], model.driver)
    everything = np.ones(len(q), dtype=np.bool_)
    pattern = SparsityPattern.build(model.dofs, everything, anew.look(c), symmetric=False)
    anew.place(c, pattern)
    into = Linearization.of(len(q), pattern.slots)
    anew.add(c, into, symmetric=True)
    lower, upper = pattern.mirror()
    into.stiffness[lower] = into.stiffness[upper]
    anew.add(c, into, symmetric=False)
    assert_allclose(into.residual, anew.residual(c), rtol=1e-12, atol=1e-15)
    along = np.zeros_like(q)
    along[:count] = 1e-7 * rng.normal(size=count)
    ahead, back = (anew.residual(replace(c, q=q + sign * along)) for sign in (1.0, -1.0))
    slope = np.zeros_like(q)
    slope[pattern.free] = pattern.product(into.stiffness, along[pattern.free])
    # what rounding leaves of a difference over a ten-thousandth of the depth
    assert_allclose(slope, 0.5 * (ahead - back), rtol=0.0, atol=1e-7 * np.abs(slope).max())
    # the tangent that Newton's method is given lacks a part
    rough = Anew(model.changing, model.driver)
    rough.place(c, pattern)
    given = Linearization.of(len(q), pattern.slots)
    rough.add(c, given, symmetric=True)
    given.stiffness[lower] = given.stiffness[upper]
    rough.add(c, given, symmetric=False)
    assert np.abs(given.stiffness - into.stiffness).max() > 1e-5 * np.abs(into.stiffness).max()
