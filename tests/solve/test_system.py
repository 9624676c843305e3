"""The assembled tangent is the derivative of the assembled residual, whatever terms stand together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import dismech_cli
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import compose
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.solve.stage import Stage
from dismech_cli.solve.step import Stepper

DECK = """
schema_version: 1
name: tangent
dimension: 2
materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.5, density: 1000}}
geometry:
  - {type: rod, name: rod, material: m, radius: 4 mm,
     generate: {shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 6}}
motions: [{type: clamp, where: rod.start}]
forces: [%s]
numerics: {integrator: {type: %s}, dt: 5 ms, t_end: 1 s}
"""
VISCOUS = "{type: viscous, coefficient: 30 N*s/m^2}"
RESISTIVE = "{type: resistive, tangential: 10 N*s/m^2, normal: 20 N*s/m^2}"
GRAVITY = "{type: gravity, acceleration: [0, 0, -9.81]}"
MOMENT = "{type: moment, where: rod.end, moment: [0, 1 mN*m, 0]}"


def _moving(tmp_path: Path, forces: str, integrator: str) -> tuple[Stepper, Stage, FloatArray, FrameState]:
    """A rod that has been pushed at random, and a guess somewhere near its next position."""
    deck = tmp_path / "tangent.yaml"
    deck.write_text(DECK % (forces, integrator))
    simulation = compose(dismech_cli.load(deck)).simulation
    stepper = Stepper(simulation.model, simulation.integrator, simulation.newton, "auto")
    random = np.random.default_rng(1)
    state = stepper.prepare(stepper.rest_state(random.normal(scale=0.1, size=simulation.model.dofs.n)))
    stage = simulation.integrator.stage(0, state, state, 5e-3)
    return stepper, stage, state.q + random.normal(scale=1e-3, size=len(state.q)), state.frames


@pytest.mark.parametrize(
    "forces", ["", VISCOUS, RESISTIVE, f"{VISCOUS}, {RESISTIVE}", f"{MOMENT}, {VISCOUS}, {RESISTIVE}"]
)
@pytest.mark.parametrize(
    "integrator", ["implicit_euler", "implicit_midpoint", "generalized_alpha", "tr_bdf2"]
)
def test_tangent_is_the_derivative_of_the_residual(tmp_path: Path, forces: str, integrator: str) -> None:
    """Central differences: h^2 and eps/h balance at 1e-8 of the largest entry."""
    stepper, stage, q, frames = _moving(tmp_path, forces, integrator)
    pattern = stepper.system.pattern
    values = stepper.system.linearize(stage, q, frames).values.copy()
    tangent = pattern.csr(values).toarray()
    if pattern.symmetric:
        tangent += np.triu(tangent, 1).T
    h = 1e-7
    difference = np.empty_like(tangent)
    for column, dof in enumerate(pattern.free):
        ends = []
        for sign in (1.0, -1.0):
            moved = q.copy()
            moved[dof] += sign * h
            at = stepper.system.linearize(stage, moved, frames)
            ends.append(at.residual[pattern.free].copy())
        difference[:, column] = (ends[0] - ends[1]) / (2.0 * h)
    assert_allclose(tangent, difference, atol=3e-8 * np.abs(difference).max())


@pytest.mark.parametrize(
    "forces", ["", GRAVITY, f"{VISCOUS}, {GRAVITY}", f"{MOMENT}, {GRAVITY}, {RESISTIVE}"]
)
@pytest.mark.parametrize("integrator", ["implicit_euler", "implicit_midpoint"])
def test_potential_and_rest_make_the_residual(tmp_path: Path, forces: str, integrator: str) -> None:
    """The slope of the energy at the stage's position and the rest, along any direction, are the residual."""
    stepper, stage, q, frames = _moving(tmp_path, forces, integrator)
    weight = stage.weights.q
    direction = np.random.default_rng(2).normal(size=len(q))
    residual = stepper.system.linearize(stage, q, frames).residual.copy()
    _, rest = stepper.system.potential(stage, q, frames)
    h = 1e-7
    ends = [stepper.system.potential(stage, q + sign * h * direction, frames)[0] for sign in (1.0, -1.0)]
    slope = (ends[0] - ends[1]) / (2.0 * h * weight)
    # h^2 and eps/h balance, as above
    size = float(np.abs(residual - rest) @ np.abs(direction))
    assert_allclose(slope, (residual - rest) @ direction, rtol=0, atol=3e-8 * size)
