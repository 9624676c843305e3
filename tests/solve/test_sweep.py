"""Stages gone through in one compiled function give the derivatives that operations on arrays give."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slope_cases import STATIC, Case, dynamics, framed, isotropic, planar

from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.solve.adjoint import Owed, adjoint
from dismech_cli.solve.differentiated import Differentiated
from dismech_cli.solve.integrators import INTEGRATORS
from dismech_cli.solve.sensitivity import forward
from dismech_cli.solve.sweep import Sweep

pytest.importorskip("numba")

from dismech_cli.kernels.numba_driver import NumbaDriver

E, RHO = "materials.rubber.youngs_modulus", "materials.rubber.density"
# a modulus and a mass; what moves held DOFs at the start and during the run, and what no share says
PLANAR = [
    (E, 1e6),
    (RHO, 1000.0),
    ("geometry[0].generate.to[0]", 0.3),
    ("motions[0].displacement[2].sine.amplitude", 0.02),
    ("forces[1].coefficient", 0.3),
]
CASES: dict[str, tuple[dict[str, Any], list[tuple[str, float]]]] = {
    **{one.name: (planar(dynamics(one.name)), PLANAR) for one in INTEGRATORS if one.name != "static"},
    "static": (planar(STATIC), [(E, 1e6), ("forces[0].acceleration[2]", -9.81)]),
    "isotropic": (isotropic(), [(E, 1e6), (RHO, 1000.0)]),
    "framed": (framed(), [(E, 1e6), ("geometry[0].generate.radius", 0.05)]),
    "framed stages": (framed(dynamics("tr_bdf2")), [(E, 1e6), ("materials.rubber.relaxation_time", 0.01)]),
}


@pytest.mark.parametrize("name", CASES)
def test_compiled_sweeps_are_those_in_batches(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    deck, where = CASES[name]
    cases = [Case(deck, *one) for one in where]
    simulation, steps = cases[0].taped()
    near = [case.neighbours() for case in cases]
    batches, swept = (
        Differentiated(simulation.model, simulation.integrator, near, driver)
        for driver in (NumpyDriver(), NumbaDriver())
    )
    found: list[bool] = []
    for way, whole in (("forward", _whole_way), ("back", _whole_way_back)):
        monkeypatch.setattr(Sweep, way, whole(getattr(Sweep, way), found))
    *_, one = forward(batches, simulation.start, steps)
    *_, other = forward(swept, simulation.start, steps)
    for a, b in (
        (one.q, other.q),
        (one.v, other.v),
        (one.a, other.a),
        *zip(one.turns, other.turns, strict=True),
    ):
        assert_allclose(b, a, rtol=0.0, atol=1e-9 * np.abs(a).max(initial=0.0))
    rng = np.random.default_rng(0)
    by_q, by_v = rng.normal(size=(2, len(simulation.start.q)))
    turns = tuple(rng.normal(size=len(edges.angles)) for edges in swept.edges)
    owed = [Owed(by_q.copy(), by_v.copy(), np.zeros_like(by_q), turns) for _ in range(2)]
    direct = adjoint(batches, simulation.start, steps, owed[0])
    assert_allclose(adjoint(swept, simulation.start, steps, owed[1]), direct, rtol=1e-9)
    assert found
    assert all(found)  # none needed a second thought


def _whole_way(sweep: Any, found: list[bool]) -> Any:
    """A sweep that notes whether it comes to where it is to end."""

    def noting(*arguments: Any) -> Any:
        *_, reach = arguments
        came = sweep(*arguments)
        found.append(came == reach)
        return came

    return noting


def _whole_way_back(sweep: Any, found: list[bool]) -> Any:
    """The same of one that goes back."""

    def noting(*arguments: Any) -> Any:
        left = sweep(*arguments)
        found.append(left == 0)
        return left

    return noting


def test_a_balance_that_is_not_stable_takes_the_second_thought(monkeypatch: pytest.MonkeyPatch) -> None:
    """A strut beyond its buckling load, still straight: its tangent is indefinite and has a derivative."""
    push = {"type": "point", "where": "arm.end", "force": [-1.0, 0, 0]}
    case = Case(planar(STATIC) | {"forces": [push], "actuation": []}, E, 1e6)
    simulation, steps = case.taped()
    found: list[bool] = []
    monkeypatch.setattr(Sweep, "forward", _whole_way(Sweep.forward, found))
    model = Differentiated(simulation.model, simulation.integrator, [case.neighbours()], NumbaDriver())
    *_, d = forward(model, simulation.start, steps)
    assert not all(found)
    # what is pushed together is inversely proportional to the modulus, but for the square of the strain
    way = steps[-1].result.state.q - simulation.start.q
    assert 0.0 < np.abs(d.q[:, 0] * 1e6 + way).max() < 0.05 * np.abs(way).max()
