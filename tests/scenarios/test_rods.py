"""Every shipped scenario: it loads, steps, and keeps what it promises."""

from __future__ import annotations

import runpy
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli import Limits, Report, load, simulate
from dismech_cli.run.loop import End
from dismech_cli.run.observables.reduce import reduce_series
from dismech_cli.scenario.language.numerics import ImplicitEuler, Newmark, Numerics, Static
from dismech_cli.scenario.load import LoadedScenario

FOLDER = Path(__file__).parents[2] / "scenarios"
NAMES = sorted(file.stem for file in FOLDER.glob("*.yaml"))
BUCKLING = {"contortion"}  # from the first step on, which is too long for it
SLOW = {
    "boundary_motion",
    "entanglement_gripper",
    "overhand_knot",
    "draped_rope",
    "draped_cloth",
    "rod_drop",
    "capstan",
    "cantilever_dynamic_1e5",
    "curl_grip",
    "dlo_manipulation",
    "folded_cloth",
    "gait",
    "helix_lead_in",
    "helix_soft",
    "helix_stiff",
    "hemisphere_hang",
    "jellyfish",
    "jellyfish_tentacles",
    "jellyfish_touch",
    "rod_on_sheet",
    "flagella",
    "heavy_fold",
    "pushed_bowl",
    "rectangular_fold",
    "slinky",
    "spider",
    "two_sheets",
    "manta_ray",
    "parachute",
    "s_shape",
    "s_shape_ideal",
    "serpentine",
    "snake",
}


def scene(name: str, *overrides: str) -> LoadedScenario:
    return load(FOLDER / f"{name}.yaml", overrides=overrides)


@cache
def finished(name: str) -> Report:
    """The scenario as written, run once for all tests."""
    result = simulate(scene(name))
    assert result.outcome.end is End.DONE, result.outcome.message
    return result


def with_numerics(loaded: LoadedScenario, numerics: Numerics, names: Sequence[str] = ()) -> LoadedScenario:
    """The scene under other numerics, with the named expectations only."""
    expect = {name: loaded.scenario.expect[name] for name in names}
    changed = loaded.scenario.model_copy(update={"numerics": numerics, "expect": expect})
    return replace(loaded, scenario=changed)


def at_rest(name: str, *overrides: str) -> np.ndarray:
    """Last node of the scene in static equilibrium."""
    numerics = Numerics(integrator=Static(type="static", load_steps=5))
    result = simulate(with_numerics(scene(name, *overrides), numerics))
    assert result.outcome.end is End.DONE, result.outcome.message
    return result.frames[-1].positions[-1]


def first_steps(loaded: LoadedScenario) -> Report:
    """Three steps, without waiting for compiled kernels."""
    numerics = loaded.scenario.numerics
    step = numerics.dt if numerics.dt is not None else 1.0 / numerics.integrator.load_steps
    return simulate(loaded, limits=Limits(until=2.5 * step), kernels="numpy")


def names_by_speed() -> list[object]:
    return [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in NAMES]


@pytest.mark.parametrize("name", NAMES)
def test_says_what_it_is(name):
    scenario = scene(name).scenario
    assert scenario.name == name
    assert len(scenario.description) > 40
    assert scenario.expect, "a scenario without expectations proves nothing"


@pytest.mark.parametrize("name", NAMES)
def test_builds_and_steps(name):
    report = first_steps(scene(name))
    outcome, simulation = report.outcome, report.composition.simulation
    assert outcome.end in (End.INTERRUPTED, End.DONE), outcome.message
    steps, cuts = min(3, len(simulation.control.grid) - 1), outcome.counters["cuts"]
    assert (cuts > 0) == (name in BUCKLING)
    assert (outcome.counters["steps"] > steps) == (cuts > 0)
    assert_allclose(outcome.state.t, simulation.control.grid[steps], rtol=1e-12)
    assert np.isfinite(outcome.state.q).all()
    assert np.abs(outcome.state.q - simulation.model.rest).max() > 0.0


@pytest.mark.parametrize("name", names_by_speed())
def test_keeps_its_promises(name):
    outcome = finished(name).outcome
    missed = []
    for what, e in scene(name).scenario.expect.items():
        measured = reduce_series(outcome.times, outcome.watched[what], e.reduce, at=e.at, after=e.after)
        if not e.tolerance.allows(measured, e.value):
            missed.append(f"{what}: measured {measured:.8g}, expected {e.value:.8g} from {e.source}")
    assert not missed, missed


# Cantilevers


def euler_bernoulli(modulus: float, length: float, radius: float = 0.02, density: float = 1000.0) -> float:
    """Tip of a round cantilever under its weight [m]."""
    return -density * 9.81 * length**4 / (2.0 * modulus * radius**2)


def first_period(modulus: float, length: float) -> float:
    return 2.0 * np.pi * (length / 1.8751041) ** 2 * np.sqrt(4.0 * 1000.0 / (modulus * 0.02**2))


def test_the_elastica_in_the_file_solves_its_boundary_value_problem():
    x, z = heavy_elastica(modulus=2e6, radius=1e-3, density=1200.0, length=0.1)
    expect = scene("cantilever").scenario.expect
    # Written with 7 digits.
    assert_allclose([expect["tip_x"].value, expect["tip_z"].value], [x, z], rtol=1e-6)
    tip = finished("cantilever").frames[-1].positions[-1]
    # Second order in the edge length: (1/100)^2 times a number of order one.
    assert_allclose(tip[[0, 2]], [x, z], rtol=1e-3)


def heavy_elastica(modulus, radius, density, length):
    """Tip (x, z) of an extensible cantilever under its own weight, to 1e-8."""
    from scipy.integrate import solve_bvp

    area, stiffness = np.pi * radius**2, modulus * np.pi * radius**4 / 4.0
    s, y = np.linspace(0.0, length, 51), np.zeros((4, 51))
    for share in (0.2, 0.4, 0.6, 0.8, 1.0):
        weight = share * density * area * 9.81

        def slopes(s, y, weight=weight):
            below = weight * (length - s)
            stretched = 1.0 - below * np.sin(y[0]) / (modulus * area)
            return np.array(
                [
                    y[1] / stiffness,
                    stretched * np.cos(y[0]) * below,
                    stretched * np.cos(y[0]),
                    stretched * np.sin(y[0]),
                ]
            )

        solution = solve_bvp(
            slopes, lambda a, b: np.array([a[0], b[1], a[2], a[3]]), s, y, tol=1e-9, max_nodes=50_000
        )
        assert solution.status == 0, solution.message
        s, y = solution.x, solution.y
    return y[2, -1], y[3, -1]


def test_small_deflection_is_that_of_beam_theory():
    exact = euler_bernoulli(2e9, 0.1, radius=1e-3, density=1200.0)
    assert_allclose(scene("cantilever_small").scenario.expect["tip"].value, exact, rtol=1e-9)
    assert_allclose(finished("cantilever_small").frames[-1].positions[-1, 2], exact, rtol=1e-3)


@pytest.mark.parametrize("modulus", ["1e5", "1e6", "1e7"])
def test_numbers_of_the_oscillating_cantilevers_are_those_of_beam_theory(modulus):
    expect = scene(f"cantilever_dynamic_{modulus}").scenario.expect
    static = euler_bernoulli(float(modulus), 0.0995)
    # The softest swings about less than its static sag, by the number of another code.
    assert_allclose(expect["mean"].value / static, 0.9834 if modulus == "1e5" else 1.0, rtol=1e-4)
    assert_allclose(expect["period"].value, first_period(float(modulus), 0.0995), rtol=5e-5)
    # A step of load moves the tip by w L^4/(E I) 4 sigma_n/beta_n^5 in mode n, by w L^4/(8 E I) at rest.
    beta = np.array([1.8751041, 4.6940911, 7.8547574, 10.9955407])
    sigma = (np.sinh(beta) - np.sin(beta)) / (np.cosh(beta) + np.cos(beta))
    share = 8.0 * 4.0 * sigma / beta**5
    # Large deflections stiffen: with 1 % at the static sag, the balance of energy gives 2 % at the turn.
    stiffening = 0.02 if modulus == "1e5" else 0.0
    swing = 2.0 * share.sum() * (1.0 - stiffening)
    assert_allclose(np.abs(expect["swing"].value / static), swing, rtol=2e-3)


def test_static_sag_is_linear_and_then_stiffens():
    tips = {e: at_rest(f"cantilever_dynamic_{e}")[2] for e in ("1e5", "1e6", "1e7")}
    for modulus in ("1e6", "1e7"):
        assert_allclose(tips[modulus], euler_bernoulli(float(modulus), 0.0995), rtol=1e-3)
    assert_allclose(tips["1e6"] / tips["1e7"], 10.0, rtol=1e-3)
    softest = tips["1e5"] / euler_bernoulli(1e5, 0.0995)
    assert 0.985 < softest < 0.999, "large deflection must sag less than beam theory says, by about 1 %"


def test_newmark_lengthens_the_period_as_theory_says():
    dt = 1.5e-3
    numerics = Numerics(integrator=Newmark(type="newmark"), dt=dt, t_end=0.6)
    outcome = simulate(with_numerics(scene("cantilever_dynamic_1e7"), numerics, ["period"])).outcome
    measured = reduce_series(outcome.times, outcome.watched["period"], "period")
    half = 0.5 * dt * 2.0 * np.pi / first_period(1e7, 0.0995)
    # The trapezoidal rule turns tan(omega dt / 2) into omega dt / 2.
    assert_allclose(measured / first_period(1e7, 0.0995), half / np.arctan(half), rtol=5e-3)
    assert half / np.arctan(half) > 1.02


def test_implicit_euler_loses_amplitude_steadily():
    numerics = Numerics(integrator=ImplicitEuler(type="implicit_euler"), dt=3e-4, t_end=0.15)
    outcome = simulate(with_numerics(scene("cantilever_dynamic_1e7"), numerics, ["mean"])).outcome
    z = outcome.watched["mean"] - euler_bernoulli(1e7, 0.0995)
    peaks = np.abs(z[1:-1][(np.abs(z[1:-1]) > np.abs(z[:-2])) & (np.abs(z[1:-1]) >= np.abs(z[2:]))])
    assert len(peaks) >= 14
    assert (np.diff(peaks) < 0.0).all()
    # Its damping ratio is omega dt / 2.
    omega = 2.0 * np.pi / first_period(1e7, 0.0995)
    decay = np.log(peaks[0] / peaks[12]) / (6.0 * first_period(1e7, 0.0995))
    assert_allclose(decay, omega**2 * 3e-4 / 2.0, rtol=0.05)


@pytest.mark.parametrize("name", ["cantilever_dynamic_1e6", "cantilever_dynamic_1e7"])
def test_an_undamped_swing_keeps_its_energy(name):
    frames = finished(name).frames
    error = np.array([frame.scalars["energy_error"] for frame in frames])
    kinetic = np.array([frame.scalars["kinetic"] for frame in frames])
    assert np.abs(error).max() < 1e-3 * kinetic.max()


# Strips


def lumped_tip(nodes: int, modulus: float) -> float:
    """Tip of the strip as a chain of rigid edges with springs and lumped weights, small deflections [m]."""
    edge = 0.1 / (nodes - 1)
    first = round(0.01 / edge)
    weight = 1200.0 * 0.02 * 1e-3 * 9.81 * edge
    stiffness = modulus * 0.02 * 1e-3**3 / 12.0
    joints = np.arange(first, nodes - 1) * edge
    loads = np.arange(first + 1, nodes) * edge
    share = np.where(np.arange(first + 1, nodes) == nodes - 1, 0.5, 1.0)
    arm = np.clip(loads[None, :] - joints[:, None], 0.0, None)
    moments = weight * (arm * share).sum(axis=1)
    return -float((moments / stiffness * edge * (0.1 - joints)).sum())


@pytest.mark.parametrize("modulus", [1e9, 2e9, 2e10])
@pytest.mark.parametrize("nodes", [21, 51, 101])
def test_strip_is_beam_theory_up_to_the_square_of_the_edge(nodes, modulus):
    tip = at_rest(f"strip_cantilever_{nodes}", f"materials.plastic.youngs_modulus={modulus}")[2]
    # What remains beside the lumped chain is the square of the slope, (9 tip / 8 L)^2 at most.
    assert_allclose(tip, lumped_tip(nodes, modulus), rtol=3e-4)
    free = 0.09 + 0.05 / (nodes - 1)
    exact = -1.5 * 1200.0 * 9.81 * free**4 / (modulus * 1e-6)
    coarseness = (0.1 / (nodes - 1) / free) ** 2
    assert abs(tip / exact - 1.0) < 3e-4 + 0.6 * coarseness
    if nodes > 21:
        assert_allclose(tip, exact, rtol=1e-3)


@pytest.mark.parametrize(
    ("modulus", "x", "z"),
    [(2e6, 0.030517, -0.082852), (1e7, 0.0670, -6.506e-2), (1e8, None, -1.1949e-2), (1e9, None, -1.21043e-3)],
)
def test_large_deflections_of_the_strip_agree_with_another_code(modulus, x, z):
    tip = at_rest("strip_cantilever_51", f"materials.plastic.youngs_modulus={modulus}")
    assert_allclose(tip[2], z, rtol=1e-3)
    if x is not None:
        assert_allclose(tip[0], x, rtol=1e-3)


# Helices


@pytest.mark.slow
def test_period_of_the_soft_helix_agrees_with_another_code_at_its_step():
    loaded = scene("helix_soft", "numerics.dt=10 ms")
    outcome = simulate(loaded).outcome
    assert_allclose(reduce_series(outcome.times, outcome.watched["period"], "period"), 0.2148, rtol=5e-3)


def test_lead_in_follows_its_formula():
    made = runpy.run_path(str(FOLDER / "data" / "make.py"))
    written = np.loadtxt(FOLDER / "data" / "helix_lead_in.csv", delimiter=",", skiprows=1)
    assert_allclose(written, made["helix_lead_in"](), atol=1e-14)


# Snakes


def short_swim(*overrides: str) -> np.ndarray:
    """Motion of the middle of a coarser snake, modelled in its plane, over two strokes [m]."""
    numerics = Numerics(integrator=ImplicitEuler(type="implicit_euler"), dt=0.05, t_end=4.0)
    coarse = scene("snake", "geometry[0].generate.nodes=31", "dimension=2", "plane=xy", *overrides)
    frames = simulate(with_numerics(coarse, numerics)).frames
    return frames[-1].positions.mean(axis=0) - frames[0].positions.mean(axis=0)


def test_snake_swims_against_its_wave_and_not_at_all_in_isotropic_drag():
    wave = "actuation[0].value.expression=39.3*(1 - cos(pi*min(t/2, 1)))/2 * sin(2*pi*0.5*t {} 2*pi*s/0.3)"
    forward = short_swim(wave.format("+"))[0]
    backward = short_swim(wave.format("-"))[0]
    assert forward > 0.2e-3
    # The mirror image, but for the phase of the wave at the start.
    assert_allclose(backward, -forward, rtol=0.05)
    still = short_swim(wave.format("+"), "forces[0].tangential=1.0")[0]
    assert abs(still) < 0.01 * forward


@pytest.mark.slow
def test_a_loosely_stopped_newton_gives_the_printed_end_of_the_small_snake(monkeypatch):
    """The code compared with stops at 1e-4 of the first residual and leaves out the turning of drag."""
    from dismech_cli.forces import resistive
    from dismech_cli.solve import step
    from dismech_cli.solve.result import NewtonResult
    from dismech_cli.solve.status import Status

    exact = resistive.RESISTIVE.function

    def unturned(y, u, p):
        force, stiffness, damping = exact(y, u, p)
        return force, tuple(0.0 * k for k in stiffness), damping

    def loosely(problem, guess):
        q, free, dt = -problem.stage.v0 * 0.05, problem.free, 0.05  # starts from the last state
        first = None
        for _ in range(25):
            trial = problem.linearize(q)
            size = np.linalg.norm(trial.residual[free])
            first = size if first is None else first
            change = problem.factorize(trial.values).solve(-trial.residual[free])
            q[free] += change
            if size <= 1e-4 or size < 1e-4 * first or np.abs(change).max() < 1e-2 * dt:
                break
        return NewtonResult(q, trial.residual.copy(), Status.CONVERGED, 1, float(size), -1)

    monkeypatch.setattr(resistive, "RESISTIVE", replace(resistive.RESISTIVE, function=unturned))
    monkeypatch.setattr(step.through_stages, "__defaults__", (loosely,))
    # what is put in its place can not be compiled
    end = simulate(scene("snake_21", "numerics.kernels=numpy")).frames[-1].positions
    assert_allclose(end[[0, -1], 0], [-0.759066, -0.666277], atol=1e-6)
    assert_allclose(end.mean(axis=0), [-0.712553, -0.006588, 0.0], atol=1e-6)


# Pneumatic fingers


@pytest.mark.parametrize(("name", "part"), [("quarter", 0.5), ("semi", 1.0), ("three_quarter", 1.5)])
def test_numbers_of_the_fingers_are_those_of_a_polygon(name, part):
    turn = 2.0 * np.arctan(0.0628525320866699 * part / 2.0)
    angles = turn * np.arange(50)
    tip = 2e-3 * np.array([np.cos(angles).sum(), -np.sin(angles).sum()])
    expect = scene(f"pneunet_{name}").scenario.expect
    assert_allclose([expect["tip_x"].value, expect["tip_z"].value], tip, atol=1e-6)


# Contortion


def test_contortion_is_antisymmetric():
    for frame in finished("contortion").frames:
        y = frame.positions[:, 1]
        assert_allclose(y, -y[::-1], atol=1e-5)
    # Another code, implicit Euler at the same step, ends at -1.640e-3 and 1.640e-3 a step earlier or later.
    assert_allclose([y.min(), y.max()], [-1.640e-3, 1.640e-3], rtol=0.02)


def test_contortion_does_not_depend_on_the_material_frame():
    turned = simulate(scene("contortion", "geometry[0].director=[0, 1, 2]"))
    plain = finished("contortion")
    directors = [np.array(result.outcome.state.frames.director) for result in (plain, turned)]
    assert np.abs(directors[0] - directors[1]).max() > 0.1
    for one, other in zip(plain.frames, turned.frames, strict=True):
        assert_allclose(one.positions, other.positions, rtol=0.0, atol=1e-8)


# Manta ray


@pytest.mark.slow
def test_the_ray_gains_more_in_each_period_and_stays_symmetric():
    frames = finished("manta_ray").frames
    start = frames[0].positions
    head = np.argmin(np.linalg.norm(start - [0.0, 0.5, 0.0], axis=1))
    times = np.array([frame.t for frame in frames])
    periods = np.arange(0.0, 5.0, 1.0 / 3.384)
    gains = np.diff(np.interp(periods, times, [frame.positions[head, 1] for frame in frames]))
    assert len(gains) == 16
    assert gains[0] > 0.0
    assert (np.diff(gains) > 0.0).all()
    mirrored = np.linalg.norm(start[:, None] * [-1.0, 1.0, 1.0] - start[None], axis=2).argmin(axis=1)
    end = frames[-1].positions
    assert_allclose(end[mirrored], end * [-1.0, 1.0, 1.0], atol=1e-6)


# Moved boundaries


def test_period_of_the_hanging_rod_solves_its_eigenvalue_problem():
    from numpy.polynomial import Legendre
    from scipy.linalg import eigh

    points, weights = np.polynomial.legendre.leggauss(60)
    s, w = 0.5 * (points + 1.0), 0.5 * weights
    shapes = [Legendre.identity(domain=[0, 1]) ** 2 * Legendre.basis(k, domain=[0, 1]) for k in range(14)]
    f, d, dd = (np.array([p.deriv(k)(s) if k else p(s) for p in shapes]) for k in range(3))
    area, inertia = np.pi * 5e-3**2, np.pi * 5e-3**4 / 4.0
    mass = 1273.52 * area
    stiffness = 1e7 * inertia * (dd * w) @ dd.T + mass * 9.81 * (d * w * (1.0 - s)) @ d.T
    lowest = eigh(stiffness, mass * (f * w) @ f.T, eigvals_only=True)[0]
    expected = scene("boundary_motion").scenario.expect["period"].value
    assert_allclose(2.0 * np.pi / np.sqrt(lowest), expected, rtol=1e-4)


def test_sag_of_the_cable_solves_its_boundary_value_problem():
    edge = 1.0 / 99.0
    sag = cable_sag(length=1.0 - edge, span=0.5 - edge)
    assert_allclose(scene("dlo_manipulation").scenario.expect["sag"].value, -sag, rtol=1e-4)


def cable_sag(length: float, span: float) -> float:
    """Sag of an extensible heavy rod between two level clamps [m]."""
    from scipy.integrate import solve_bvp
    from scipy.optimize import brentq

    radius, modulus = 1.6e-3, 1.8e5
    area, bending = np.pi * radius**2, modulus * np.pi * radius**4 / 4.0
    weight = 1180.0 * area * 9.8

    def slopes(s, y, p):
        down = -weight * (0.5 * length - s)
        stretched = 1.0 + (p[0] * np.cos(y[0]) + down * np.sin(y[0])) / (modulus * area)
        return np.array(
            [
                y[1] / bending,
                stretched * (p[0] * np.sin(y[0]) - down * np.cos(y[0])),
                stretched * np.cos(y[0]),
                stretched * np.sin(y[0]),
            ]
        )

    a = brentq(lambda a: 2.0 * a * np.sinh(span / (2.0 * a)) - length, 1e-2, 10.0)
    s = np.linspace(0.0, 0.5 * length, 2001)
    t = (s - 0.5 * length) / a
    angle, x, z = np.arctan(t), a * np.arcsinh(t), a * np.sqrt(1.0 + t**2)
    start = np.array([angle, bending * np.gradient(angle, s), x - x[0], z - z[0]])
    solution = solve_bvp(
        slopes,
        lambda a, b, p: np.array([a[0], b[0], a[2], a[3], b[2] - 0.5 * span]),
        s,
        start,
        p=np.array([a * weight]),
        tol=1e-6,
        max_nodes=100_000,
    )
    assert solution.status == 0, solution.message
    return -float(solution.y[3, -1])
