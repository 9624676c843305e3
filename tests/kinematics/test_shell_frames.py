"""Mid-edge normals in time: large rotations cost nothing, however they are stepped."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from derivatives import Probe
from numpy.testing import assert_allclose
from shell_cases import NUMPY, Material, Shell, pressed, shell
from shell_states import configured, disturbed, relaxed, stored_at

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.load import DeadLoad
from dismech_cli.kinematics.motion import Motion
from dismech_cli.kinematics.rod_frames import FrameState, NoFrames, TrialFrames
from dismech_cli.kinematics.shell_frames import ShellFrames
from dismech_cli.laws.laws import Constant, Ramp
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.model.model import Model
from dismech_cli.solve.integrators import GeneralizedAlpha, Static
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

CAP = hemisphere(1.0, 4)


def about_x(angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])


def turned(made: Shell, q: FloatArray, angle: float) -> FloatArray:
    split = made.model.dofs.n_positions
    out = q.copy()
    out[:split] = (q[:split].reshape(-1, 3) @ about_x(angle).T).reshape(-1)
    return out


@dataclass(frozen=True)
class Three(NoFrames):
    """Frames of rods with three inputs."""

    size: ClassVar[int] = 3

    def transport(self, stored: FrameState, q: FloatArray) -> TrialFrames:
        return TrialFrames(super().rest(q), np.array([7.0, 8.0, 9.0]))


def test_places_of_the_auxiliary_array() -> None:
    """Behind those of the rods, each number of the stored normals in one place."""
    made = shell(CAP, "midedge")
    assert isinstance(made.model.frames, ShellFrames)
    frames = replace(made.model.frames, rods=Three())
    q = disturbed(made, 0.1)
    stored = replace(frames.rest(made.model.rest), edge_angle=np.linspace(-1.0, 1.0, len(frames.angles)))
    auxiliary = frames.transport(stored, q).auxiliary
    places = frames.edge_places(np.arange(len(frames.angles)))
    assert np.array_equal(auxiliary[places[:, 0:3]], stored.edge_tangent.T)
    assert np.array_equal(auxiliary[places[:, 3:6]], stored.edge_normal.T)
    assert np.array_equal(auxiliary[places[:, 6]], stored.edge_angle)
    assert np.array_equal(np.sort(places, axis=None), np.arange(3, frames.size))
    assert len(auxiliary) == frames.size


def test_a_turned_bell_stays_free_of_stress() -> None:
    """One radian in a single step, against the energy of flattening the bell: far below 1e-10 of it."""
    made = shell(CAP, "midedge")
    term = made.term("bend")
    q = turned(made, made.model.rest, 1.0)
    rest = made.model.frames.rest(made.model.rest)
    probe = Probe.of(term, made.model, NUMPY)
    q = relaxed(made, rest, q)
    flat = made.with_naturals("bend", np.zeros((3, len(made.areas))))
    flattening = Probe.of(flat.term("bend"), made.model, NUMPY).energy(
        configured(made, rest, made.model.rest)
    )
    assert flattening > 0.0
    c = configured(made, rest, q)
    assert probe.energy(c) < 1e-25 * flattening
    # and the next step starts from normals that fit the turned bell
    again = configured(made, c.frames.state, q)
    assert probe.energy(again) < 1e-25 * flattening
    normals = made.model.frames.rest(made.model.rest).edge_normal
    assert_allclose(c.frames.state.edge_normal, about_x(1.0) @ normals, rtol=0, atol=1e-13)


def test_storing_the_normals_does_not_change_the_energy() -> None:
    """Accepting a step turns no mid-edge normal: same angles before and after."""
    made = shell(CAP, "midedge")
    q = disturbed(made, 0.3)
    probe = Probe.of(made.term("bend"), made.model, NUMPY)
    before = configured(made, made.model.frames.rest(made.model.rest), q)
    after = configured(made, before.frames.state, q)
    assert_allclose(probe.energy(after), probe.energy(before), rtol=1e-12)
    split = made.model.dofs.n_positions
    r = probe.residual(before)
    assert_allclose(probe.residual(after)[split:], r[split:], rtol=0, atol=1e-12 * np.abs(r).max())


def test_forces_do_not_depend_on_the_stored_frames() -> None:
    """In balance of the normals: from the rest frames or from frames that followed in steps."""
    made = shell(CAP, "midedge")
    q = turned(made, disturbed(made, 0.3), 0.8)
    probe = Probe.of(made.term("bend"), made.model, NUMPY)
    forces = []
    for stored in (made.model.frames.rest(made.model.rest), stored_at(made, q)):
        x = relaxed(made, stored, q)
        forces.append(probe.residual(configured(made, stored, x))[: made.model.dofs.n_positions])
    size = np.abs(forces[0]).max()
    assert size > 0.0
    assert_allclose(forces[1], forces[0], rtol=0, atol=1e-11 * size)


def test_the_words_for_a_normal() -> None:
    dofs = shell(CAP, "midedge").model.dofs
    assert dofs.describe(dofs.n_positions + 7) == "mid-edge normal of shell edge 7"
    assert dofs.n == dofs.n_positions + dofs.n_normals


def strip(loaded: float) -> Model:
    """A strip clamped at its left side, edge normals included, bent far by a dead load."""
    sheet_material = Material(youngs_modulus=1e6, poisson_ratio=0.0, thickness=0.01)
    made = shell(sheet(1.0, 0.2, 12, Pattern.RIGHT), "midedge", material=sheet_material)
    model, dofs = made.model, made.model.dofs
    root = made.mesh.nodes[:, 0] == 0.0
    held = np.concatenate(
        (dofs.of_nodes(np.flatnonzero(root)).reshape(-1), dofs.of_normals(made.edges_among(root)))
    )
    load = DeadLoad("load", pressed(made, -loaded), Ramp(before=0.0, after=1.0, start=0.0, end=1.0))
    motion = Motion("clamp", held, model.rest[held], Constant(0.0))
    return replace(model, mass=0.0 * model.mass, terms=(*model.terms, load), motions=(motion,))


def test_load_steps_do_not_change_a_static_answer() -> None:
    """The tip turns by one radian: one load step, or ten."""
    tips = []
    for steps in (1, 10):
        stepper = Stepper(strip(2.0), Static(), NewtonSettings(), "auto")
        state = stepper.prepare(stepper.rest_state())
        for _ in range(steps):
            result = stepper.step(state, 1.0 / steps)
            assert result.status is Status.CONVERGED
            state = result.state
        tips.append(state.q[: stepper.model.dofs.n_positions].reshape(-1, 3)[-1])
    assert tips[0][2] < -0.4
    assert_allclose(tips[1], tips[0], rtol=0, atol=1e-7)


@pytest.mark.parametrize("bending", ["hinge", "midedge", "averaged"])
def test_a_free_shell_keeps_its_momentum(bending: str) -> None:
    """A tumbling, vibrating cap without loads: linear momentum to Newton's tolerance."""
    made = shell(CAP, bending, material=Material(1e4, 0.3, 0.02, 10.0))
    dofs, rng = made.model.dofs, np.random.default_rng(0)
    mass = made.model.mass[: dofs.n_positions].reshape(-1, 3)
    v = np.zeros(dofs.n)
    x = CAP.nodes - CAP.nodes.mean(axis=0)
    swirl = np.cross([3.0, 1.0, -2.0], x) + rng.normal(size=x.shape) * 0.2
    v[: dofs.n_positions] = swirl.reshape(-1)
    stepper = Stepper(made.model, GeneralizedAlpha(), NewtonSettings(1e-10), "auto")
    state = stepper.prepare(stepper.rest_state(v))
    momentum = (mass * swirl).sum(axis=0)
    for _ in range(20):
        result = stepper.step(state, 5e-3)
        assert result.status is Status.CONVERGED
        state = result.state
    after = (mass * state.v[: dofs.n_positions].reshape(-1, 3)).sum(axis=0)
    assert_allclose(after, momentum, rtol=0, atol=1e-8 * np.abs(mass * swirl).sum())
