"""The law of pairs that the DisMech family has: its formulas, its forces, and a run of its data."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_decks import MASS, crossing, on_floor
from numpy.testing import assert_allclose

import dismech_cli
from dismech_cli.arrays import FloatArray
from dismech_cli.contact.points.softplus import softplus
from dismech_cli.errors import ScenarioError
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.model.configuration import Configuration

DATA = Path(__file__).parents[1] / "data" / "rod_drop_family.csv"
SCENE = Path(__file__).parents[2] / "scenarios" / "verification" / "rod_drop_family.yaml"


def test_deep_inside_it_is_quadratic_and_beyond_the_width_nothing() -> None:
    width, k = 1e-3, 20.0
    gap = np.array([-3.0, -1.0, 1.0]) * width
    energy, slope, curvature = softplus(gap, 15.0 / width, k)
    # the branches of the family differ from this one by 4e-8 and 4e-16 k d^2
    assert_allclose(energy, [9.0 * k * width**2, k * width**2, 0.0], atol=4.1e-8 * k * width**2)
    assert_allclose(energy[2], 0.0, atol=5e-16 * k * width**2)
    assert_allclose(slope[0], -6.0 * k * width, rtol=1e-12)
    assert_allclose(curvature[0], 2.0 * k, rtol=1e-12)
    _, slope, _ = softplus(np.zeros(1), 15.0 / width, k)
    # L = d log(2) / 15 and half of the sigmoid
    assert_allclose(-slope, k * width * np.log(2.0) / 15.0, rtol=1e-14)


def test_slope_and_curvature_are_derivatives() -> None:
    gap = np.linspace(-2e-3, 2e-3, 41)
    h = 1e-20
    step = gap + 1j * h

    def soft(g: Any) -> Any:
        return 20.0 * (np.log1p(np.exp(-15e3 * g)) / 15e3) ** 2

    _, slope, curvature = softplus(gap, 15e3, 20.0)
    assert_allclose(slope, soft(step).imag / h, rtol=1e-10, atol=1e-20)
    _, ahead, _ = softplus(gap + 1e-9, 15e3, 20.0)
    _, behind, _ = softplus(gap - 1e-9, 15e3, 20.0)
    assert_allclose(curvature, (ahead - behind) / 2e-9, rtol=1e-6, atol=1e-6 * curvature.max())


def pressed(law: dict[str, Any]) -> dict[str, Any]:
    """Two rods that cross within the width of the law."""
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": {"type": "compat", **law}}
    for end in ("from", "to"):
        deck["geometry"][1]["generate"][end][2] = 0.0041
    return deck


def test_forces_are_those_of_the_energy_and_leave_no_net_force() -> None:
    scene = pressed({"stiffness": 100.0, "width": 1e-3})
    report = dismech_cli.simulate(scene, limits=dismech_cli.Limits(until=0.0))
    model = report.composition.simulation.model
    contacts = model.changing[0].start(NumpyDriver())
    normal = contacts.terms[0]
    potential = normal.potential
    assert potential is not None

    def at(q: FloatArray) -> Configuration:
        c = Configuration(0.0, q, np.zeros_like(q), model.frames.transport(model.frames.rest(q), q))
        contacts.detect(c)
        return c

    q = model.rest
    residual = np.zeros_like(q)
    normal.add_residual(at(q), residual)
    # one pair of edges at 4.1 mm, which touches at 4 mm
    soft = np.log1p(np.exp(-1.5)) / 15e3
    energy = float(potential.energy(at(q)).sum())
    assert_allclose(energy, 100.0 * soft**2, rtol=1e-11)
    forces = residual[: model.dofs.n_positions].reshape(-1, 3)
    assert_allclose(forces.sum(axis=0), 0.0, atol=1e-14 * np.abs(forces).max())
    rng = np.random.default_rng(2)
    way = np.zeros_like(q)
    way[: model.dofs.n_positions] = rng.standard_normal(model.dofs.n_positions)
    h = 1e-8
    change = float(potential.energy(at(q + h * way)).sum() - potential.energy(at(q - h * way)).sum())
    assert_allclose(residual @ way, change / (2.0 * h), rtol=1e-5)


def test_momentum_passes_from_one_to_the_other() -> None:
    deck = crossing(1e-3, 1.0)
    deck["contact"] = {"law": {"type": "compat", "stiffness": 2e4, "width": 1e-3}}
    report = dismech_cli.simulate(deck)
    state, model = report.outcome.state, report.composition.simulation.model
    momentum = (model.mass * state.v)[: model.dofs.n_positions].reshape(-1, 3)
    total = 1000.0 * np.pi * 0.002**2 * 0.5
    assert_allclose(momentum.sum(axis=0), [0.0, 0.0, -total], atol=1e-10 * total)
    assert momentum[:6, 2].sum() < -0.2 * total
    assert (report.scalars["high"] > report.scalars["low"]).all()


@pytest.mark.parametrize(("normal_force", "steps_late"), [("implicit", 0), ("lagged", 1)])
def test_friction_by_the_normal_force_of_the_moment_or_of_the_last_step(
    normal_force: str, steps_late: int
) -> None:
    """A rod that is pulled over a floor: friction that lags is not there in the first step."""
    deck = on_floor(8.0)
    deck["contact"]["law"] = {"type": "compat", "stiffness": 1e3, "width": 5e-3, "normal_force": normal_force}
    deck["numerics"]["integrator"] = {"type": "implicit_euler"}
    report = dismech_cli.simulate(deck)
    friction = 0.4 * MASS * 9.8
    impulse = (8.0 - friction) * 1.0 + friction * steps_late * 5e-3
    assert_allclose(report.scalars["kinetic"][-1], impulse**2 / (2.0 * MASS), rtol=1e-4)


def test_two_sheets_by_pairs() -> None:
    """Edges with edges and nodes with triangles; one sheet falls on the other and hands its momentum on."""

    def sheet(name: str, origin: list[float]) -> dict[str, Any]:
        plan = {"shape": "sheet", "origin": origin, "length": 0.1, "width": 0.1, "divisions": 1}
        return {
            "type": "shell",
            "name": name,
            "material": "m",
            "thickness": 1e-2,
            "bending": "midedge",
            "generate": plan,
        }

    deck = {
        "schema_version": 1,
        "name": "sheets",
        "materials": {"m": {"youngs_modulus": 2e8, "poisson_ratio": 0.5, "density": 1200.0}},
        "geometry": [sheet("low", [0.0, 0.0, 0.0]), sheet("high", [0.03, 0.02, 0.05])],
        "contact": {"law": {"type": "compat", "stiffness": 4e4, "width": 1e-4}},
        "initial_velocity": [{"where": "high", "velocity": [0.0, 0.0, -0.5]}],
        "numerics": {"dt": 1e-3, "t_end": 0.2},
    }
    report = dismech_cli.simulate(deck)
    state, model = report.outcome.state, report.composition.simulation.model
    momentum = (model.mass * state.v)[: model.dofs.n_positions].reshape(-1, 3)
    total = 1200.0 * 1e-2 * 0.01 * 0.5
    assert_allclose(momentum.sum(axis=0), [0.0, 0.0, -total], atol=1e-10 * total)
    assert momentum[:4, 2].sum() < -0.2 * total
    assert 0.0 < state.memory["contact.worst"][0] < 0.05
    assert report.scalars["error"].max() < 1e-3 * report.scalars["kinetic"][0]


def test_what_it_cannot_do_is_refused() -> None:
    deck = on_floor()
    deck["contact"]["law"] = {"type": "compat", "stiffness": 1e4, "width": 5e-3}
    deck["obstacles"] = [{"name": "floor", "type": "sphere", "center": [0, 0, -1.0], "radius": 1.0}]
    with pytest.raises(ScenarioError, match="the law `compat` knows planes only"):
        dismech_cli.simulate(deck)
    deck = on_floor()
    deck["contact"]["friction"] = {"coefficient": 0.4, "stick": "anchored"}
    deck["contact"]["law"] = {"type": "compat", "stiffness": 1e4, "width": 5e-3}
    with pytest.raises(ScenarioError, match="anchors know soft contact alone"):
        dismech_cli.simulate(deck)
    deck = on_floor()
    del deck["contact"]["friction"]
    deck["contact"]["law"] = {"type": "compat", "stiffness": 1e4, "width": 5e-3, "normal_force": "lagged"}
    with pytest.raises(ScenarioError, match="which goes by it"):
        dismech_cli.simulate(deck)


@pytest.mark.slow
def test_a_stiff_rod_bounces_as_the_data_of_the_family_say() -> None:
    """Four impacts of either end: errors of rounding grow in each, to a quarter of the radius."""
    report = dismech_cli.simulate(SCENE, overrides=["numerics.t_end=0.45 s", "expect={}"])
    t, x, y, z = np.loadtxt(DATA, delimiter=",", skiprows=1).T
    at = np.round(t / 1e-4).astype(int)
    assert_allclose(report.scalars["t"][at], t, atol=1e-9)
    for name, data in (("low", z), ("slid", x)):
        off = np.abs(report.scalars[name][at] - data)
        assert off[t < 0.13].max() < 1e-6
        assert off[t < 0.2].max() < 2e-5
        assert off.max() < 2.5e-4
    # it stays in the upright plane that it starts in
    assert_allclose(y, 0.5 * x, atol=1e-7)
