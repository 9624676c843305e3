"""Integrators: declared orders observed, affine maps, exact motions, momentum, energy, frequency."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from cases import (
    MODELS,
    UNEQUAL,
    clamped,
    framed_rod,
    helix,
    planar_rod,
    properties,
    straight,
    weighted,
    with_term,
)
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.viscous import ViscousDamping
from dismech_cli.kinematics.motion import Motion
from dismech_cli.laws.laws import Constant, Sine
from dismech_cli.model.model import Model
from dismech_cli.model.state import State
from dismech_cli.solve.integrators import (
    GeneralizedAlpha,
    ImplicitEuler,
    ImplicitMidpoint,
    Integrator,
    Newmark,
    Static,
    TrBdf2,
)
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

INTEGRATORS: list[Integrator] = [ImplicitEuler(), ImplicitMidpoint(), Newmark(), GeneralizedAlpha(), TrBdf2()]
SECOND_ORDER = INTEGRATORS[1:]
TIGHT = NewtonSettings(tolerance=1e-12)


def name(integrator: Integrator) -> str:
    return integrator.name


def run(
    model: Model, integrator: Integrator, dt: float, steps: int, velocity: FloatArray | None = None
) -> list[State]:
    """All states of a run from rest shape with a given velocity."""
    stepper = Stepper(model, integrator, TIGHT, "auto")
    states = [stepper.prepare(stepper.rest_state(velocity))]
    for _ in range(steps):
        result = stepper.step(states[-1], dt)
        assert result.status is Status.CONVERGED
        states.append(result.state)
    return states


def flick(model: Model, speed: float) -> FloatArray:
    """A smooth velocity that bends a cantilever along x, growing as the square of the distance."""
    x = model.dofs.embed(model.dofs.positions(model.rest))
    v = np.zeros((len(x), 3))
    v[:, 2] = speed * (x[:, 0] - x[1, 0]).clip(0.0) ** 2
    v[:, 1] = 0.5 * v[:, 2]
    out = np.zeros(model.dofs.n)
    out[: model.dofs.n_positions] = model.dofs.project(v).reshape(-1)
    return out


# Soft in every way: no frequency is far above that of the motion, so dt resolves all of them.
SOFT = properties(axial=3.0, bending=0.05, torsional=0.01, mass_per_length=1.0)


def swinging(kind: str) -> Model:
    """A short soft cantilever; the framed one is bent in space and twisted by its angle inertia."""
    if kind == "planar":
        return clamped(planar_rod(*straight(6, 1.0), SOFT), (0, 1))
    nodes, edges = straight(5, 1.0)
    nodes[:, 1] = 0.3 * nodes[:, 0] ** 2
    return clamped(framed_rod(nodes, edges, replace(SOFT, bending_1=0.08)), (0, 1), (0,))


def _observed(model: Model, integrator: Integrator, end: float, counts: list[int]) -> float:
    velocity = flick(model, 2.0)
    if model.dofs.n_angles:
        velocity[model.dofs.n_positions + 1 :] = 3.0
    finals = []
    for count in counts:
        last = run(model, integrator, end / count, count, velocity)[-1]
        finals.append(np.concatenate((last.q, last.v)))
    assert np.abs(finals[-1][: model.dofs.n] - model.rest).max() > 0.3
    errors = np.array([np.abs(a - b).max() for a, b in pairwise(finals)])
    return observed_order(1.0 / np.array(counts[:-1]), errors)


@pytest.mark.parametrize("integrator", INTEGRATORS, ids=name)
def test_order_on_a_planar_cantilever(integrator: Integrator) -> None:
    """Differences of successive halvings fall with the declared order, positions and velocities."""
    counts = [80, 160, 320] if integrator.order == 2 else [200, 400, 800]
    assert _observed(swinging("planar"), integrator, 0.6, counts) == pytest.approx(integrator.order, abs=0.1)


@pytest.mark.parametrize("integrator", [GeneralizedAlpha(), TrBdf2()], ids=name)
def test_order_on_a_framed_rod(integrator: Integrator) -> None:
    """Transport of frames from step to step costs no order."""
    assert _observed(swinging("framed"), integrator, 0.4, [40, 80, 160]) == pytest.approx(2, abs=0.1)


def test_newmark_with_other_gamma_is_first_order() -> None:
    integrator = Newmark(beta=0.36, gamma=0.7)
    assert integrator.order == 1
    assert _observed(swinging("planar"), integrator, 0.6, [200, 400, 800]) == pytest.approx(1, abs=0.1)


# ---------------------------------------------------------------- affine maps


def _random_state(seed: int, n: int = 3, t: float = 1.7) -> State:
    q, v, a = np.random.default_rng(seed).normal(size=(3, n))
    frames = planar_rod(*straight(2), UNEQUAL).frames.rest(q)
    return State(t, q, v, a, frames)


@pytest.mark.parametrize("integrator", [*INTEGRATORS, Static()], ids=name)
def test_weights_are_the_slopes_of_the_maps(integrator: Integrator) -> None:
    """Affine maps: a difference quotient is exact to round-off at any distance."""
    start, latest, dt = _random_state(1), _random_state(2, t=1.8), 0.3
    for index in range(integrator.stages):
        stage = integrator.stage(index, start, latest, dt)
        q, d = np.random.default_rng(3).normal(size=(2, 3))
        w = stage.weights
        atol = 1e-14 / dt**2 * 10.0
        for at, slope in ((stage.position, w.q), (stage.velocity, w.v), (stage.acceleration, w.a)):
            assert_allclose(at(q + d) - at(q), slope * d, rtol=1e-12, atol=atol)
        for part, slope in enumerate((stage.v_end[0], stage.a_end[0])):
            assert_allclose(
                stage.finish(q + d)[part] - stage.finish(q)[part], slope * d, rtol=1e-12, atol=atol
            )
        assert start.t <= stage.t_stage <= stage.t_end <= start.t + dt * (1.0 + 1e-15)


@pytest.mark.parametrize("integrator", SECOND_ORDER, ids=name)
def test_constant_acceleration_is_reproduced(integrator: Integrator) -> None:
    """A parabola satisfies every map: stage and end have its velocity and acceleration."""
    s, dt = _random_state(4), 0.3

    def on_path(t: float) -> State:
        h = t - s.t
        return replace(s, t=t, q=s.q + h * s.v + 0.5 * h * h * s.a, v=s.v + h * s.a)

    latest = s
    for index in range(integrator.stages):
        stage = integrator.stage(index, s, latest, dt)
        end = on_path(stage.t_end)
        assert_allclose(stage.predictor, end.q, rtol=1e-13)
        assert_allclose(stage.acceleration(end.q), s.a, rtol=0, atol=1e-12)
        assert_allclose(stage.velocity(end.q), on_path(stage.t_stage).v, rtol=0, atol=1e-13)
        v, a = stage.finish(end.q)
        assert_allclose(v, end.v, rtol=0, atol=1e-13)
        assert_allclose(a, s.a, rtol=0, atol=1e-12)
        latest = end
    assert_allclose(latest.t, s.t + dt, rtol=1e-15)


def test_static_has_no_inertia() -> None:
    s = _random_state(5)
    stage = Static().stage(0, s, s, 0.1)
    assert (stage.weights.v, stage.weights.a) == (0.0, 0.0)
    assert_allclose(stage.velocity(s.q), 0.0, atol=0.0)
    assert_allclose(stage.acceleration(s.q), 0.0, atol=0.0)


# ---------------------------------------------------------------- start


@pytest.mark.parametrize("kind", ["planar", "framed"])
def test_consistent_initial_acceleration(kind: str) -> None:
    """M a + r(q, v) = 0 at the start: gravity less damping, on free DOFs; held ones do not accelerate."""
    model = weighted(swinging(kind), (0.0, 0.0, -9.81), Constant(1.0))
    positions = np.arange(model.dofs.n_positions)
    dofs = positions.reshape(model.dofs.n_nodes, -1)
    model = with_term(model, ViscousDamping("damping", dofs, np.full(len(dofs), 0.7)))
    velocity = flick(model, 2.0)
    stepper = Stepper(model, Newmark(), TIGHT, "auto")
    a = stepper.prepare(stepper.rest_state(velocity)).a
    held = model.motions[0].dofs
    expected = np.zeros(model.dofs.n)
    expected[positions] = -0.7 * velocity[positions] / model.mass[positions]
    expected[positions[model.dofs.axes.index(2) :: model.dofs.dimension]] -= 9.81
    expected[held] = 0.0
    # internal forces vanish at rest up to round-off of EA / l
    assert_allclose(a, expected, rtol=0, atol=1e-12 * 9.81)


# ---------------------------------------------------------------- exact motions


@pytest.mark.parametrize("kind", MODELS)
@pytest.mark.parametrize("integrator", INTEGRATORS, ids=name)
def test_free_fall(integrator: Integrator, kind: str) -> None:
    """Exact for second order; implicit Euler falls g dt t / 2 too far, exactly."""
    model = weighted(MODELS[kind](*straight(4, 1.0), UNEQUAL), (0.0, 0.0, -9.81), Constant(1.0))
    velocity = np.zeros(model.dofs.n)
    velocity[: model.dofs.n_positions] = np.tile(model.dofs.project(np.array([0.5, 0.2, 2.0])), 4)
    dt, steps = 0.05, 20
    last = run(model, integrator, dt, steps, velocity)[-1]
    t = dt * steps
    fall = -0.5 * 9.81 * t * (t + dt if integrator.order == 1 else t)
    path = np.array([0.5, 0.2, 2.0]) * t + [0.0, 0.0, fall]
    moved = model.dofs.positions(last.q) - model.dofs.positions(model.rest)
    # 20 steps, each converged to 1e-12 of the weight
    assert_allclose(moved, np.tile(model.dofs.project(path), (4, 1)), rtol=0, atol=1e-11)
    velocity_end = model.dofs.project(np.array([0.5, 0.2, 2.0 - 9.81 * t]))
    assert_allclose(model.dofs.positions(last.v), np.tile(velocity_end, (4, 1)), rtol=0, atol=1e-10)


@pytest.mark.parametrize("integrator", INTEGRATORS, ids=name)
def test_linear_momentum_of_a_free_rod(integrator: Integrator) -> None:
    """A bent and twisted rod flies off: whatever it does inside, its momentum stays."""
    model = framed_rod(*helix(6), UNEQUAL)
    rng = np.random.default_rng(2)
    stepper = Stepper(model, integrator, TIGHT, "auto")
    start = stepper.rest_state(0.5 * rng.normal(size=model.dofs.n))
    q = start.q + 0.05 * rng.normal(size=model.dofs.n)
    start = replace(start, q=q, frames=model.frames.transport(start.frames, q).state)
    state = stepper.prepare(start)
    mass = model.dofs.positions(model.mass)
    before = (mass * model.dofs.positions(state.v)).sum(axis=0)
    size = (mass * np.abs(model.dofs.positions(state.v))).sum()
    for _ in range(30):
        result = stepper.step(state, 0.02)
        assert result.status is Status.CONVERGED
        state = result.state
    assert np.abs(state.q - q).max() > 0.1
    after = (mass * model.dofs.positions(state.v)).sum(axis=0)
    assert_allclose(after, before, rtol=0, atol=1e-10 * size)


# ---------------------------------------------------------------- oscillators


def oscillator() -> tuple[Model, float]:
    """A mass on a spring: two nodes along x, the first held; linear as long as it stays on its axis."""
    rod = properties(axial=8.0, bending=1.0, torsional=1.0, mass_per_length=1.0)
    model = clamped(planar_rod(*straight(2, 1.0), rod), (0,))
    return model, float(np.sqrt(8.0 / 0.5))


@pytest.mark.parametrize("integrator", [ImplicitMidpoint(), Newmark()], ids=name)
@pytest.mark.parametrize("resolution", [0.1, 1.0, 5.0])
def test_frequency_of_the_trapezoidal_rule(integrator: Integrator, resolution: float) -> None:
    """tan(omega_d dt / 2) = omega dt / 2 to round-off, amplitude kept: no damping at any step."""
    model, omega = oscillator()
    dt, amplitude = resolution / omega, 1e-3
    velocity = np.array([0.0, 0.0, amplitude * omega, 0.0])
    states = run(model, integrator, dt, 40, velocity)
    phase = 2.0 * np.arctan(0.5 * resolution) * np.arange(41)
    x = np.array([s.q[2] - 1.0 for s in states])
    v = np.array([s.v[2] for s in states])
    # positions of order one: 40 steps with an ulp each
    assert_allclose(v, amplitude * omega * np.cos(phase), rtol=0, atol=1e-13 * omega)
    assert_allclose(x, amplitude * np.sin(phase), rtol=0, atol=1e-13)


@pytest.mark.parametrize("radius", [0.0, 0.5, 0.8, 1.0])
def test_generalized_alpha_damps_high_frequencies_as_told(radius: float) -> None:
    """For omega dt to infinity the amplitude falls per step by the chosen spectral radius."""
    model, omega = oscillator()
    states = run(model, GeneralizedAlpha(radius), 3e3 / omega, 40, np.array([0.0, 0.0, 1e-6 * omega, 0.0]))
    size = np.array([abs(s.q[2] - 1.0) + abs(s.v[2]) * 3e3 / omega for s in states])
    if radius == 0.0:
        assert size[4:].max() < 1e-5 * size[1]
    else:
        # a double root makes the envelope n * radius^n: compare late ratios over several steps
        ratio = (size[40] / size[20]) ** (1.0 / 20.0)
        assert ratio == pytest.approx(radius, rel=0.06)


def energies(model: Model, states: list[State]) -> FloatArray:
    stepper = Stepper(model, Newmark(), TIGHT, "auto")
    stepper.prepare(states[0])
    out = []
    for s in states:
        stage = Static().stage(0, s, s, 0.0)
        potential, _ = stepper.system.potential(stage, s.q, s.frames)
        out.append(potential + 0.5 * float(model.mass @ s.v**2))
    return np.array(out)


def test_midpoint_keeps_the_energy_of_a_linear_oscillator() -> None:
    model, omega = oscillator()
    e = energies(model, run(model, ImplicitMidpoint(), 0.7 / omega, 200, np.array([0.0, 0.0, 0.1, 0.0])))
    assert_allclose(e, e[0], rtol=1e-10)


def test_energy_of_a_swinging_rod() -> None:
    """Midpoint errs by dt^2 without drift; implicit Euler loses energy at every step."""
    model = swinging("planar")
    velocity = flick(model, 2.0)
    spread = []
    for count in (200, 400):
        e = energies(model, run(model, ImplicitMidpoint(), 3.0 / count, count, velocity))
        spread.append(np.abs(e - e[0]).max() / e[0])
        half = len(e) // 2
        assert abs(e[half:].mean() - e[:half].mean()) < 0.5 * np.ptp(e)
    assert spread[1] < 0.02
    assert spread[0] / spread[1] == pytest.approx(4.0, rel=0.15)
    lossy = energies(model, run(model, ImplicitEuler(), 3.0 / 200, 200, velocity))
    assert (np.diff(lossy) < 0.0).all()


# ---------------------------------------------------------------- prescribed motion


@pytest.mark.parametrize("integrator", INTEGRATORS, ids=name)
def test_prescribed_nodes_are_where_they_must_be(integrator: Integrator) -> None:
    """Held DOFs follow their law at every step end, and their velocity is its difference quotient."""
    model = planar_rod(*straight(5, 1.0), SOFT)
    held = model.dofs.of_nodes(np.array([0, 1]))[:, 1]
    law = Sine(amplitude=0.05, frequency=1.0)
    along = model.dofs.of_nodes(np.array([0, 1]))[:, 0]
    model = replace(
        model,
        motions=(
            Motion("shaker", held, model.rest[held], law),
            Motion("guide", along, model.rest[along], Constant(0.0)),
        ),
    )
    dt = 0.02
    states = run(model, integrator, dt, 20)
    for state in states[1:]:
        assert_allclose(state.q[held], 0.05 * np.sin(2.0 * np.pi * state.t), rtol=0, atol=1e-15)
    if integrator.stages == 1:
        quotient = (states[-1].q[held] - states[-2].q[held]) / dt
        assert_allclose(states[-1].v[held], quotient, rtol=1e-12)
    assert np.abs(states[-1].q[-1]) > 1e-3
