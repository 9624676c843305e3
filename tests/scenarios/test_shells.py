"""Scenes of shells: closed forms behind their numbers, and why those of other codes differ."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial import Legendre, Polynomial
from numpy.polynomial.legendre import leggauss
from numpy.testing import assert_allclose

from dismech_cli import Limits, load, simulate
from dismech_cli.run.loop import End
from dismech_cli.scenario.load import LoadedScenario

FOLDER = Path(__file__).parents[2] / "scenarios"
NAMES = ["shell_cantilever_midedge", "shell_cantilever_hinge", "parachute", "hemisphere_hang", "manta_ray"]
NAMES += ["jellyfish", "jellyfish_tentacles"]
BEAM = 1.5 * 1200.0 * 9.81 * 0.09**4 / (2e9 * 1e-3**2)


def scene(name: str, *overrides: str) -> LoadedScenario:
    return load(FOLDER / f"{name}.yaml", overrides=overrides)


def positions(name: str, *overrides: str, until: float = float("inf")) -> tuple[np.ndarray, np.ndarray]:
    """Positions at the start and the end of a run."""
    report = simulate(scene(name, *overrides), limits=Limits(until=until), kernels="numpy")
    assert report.outcome.end in (End.DONE, End.INTERRUPTED), report.message
    return report.frames[0].positions, report.frames[-1].positions


def tip(name: str, *overrides: str) -> float:
    """Mean sag of the nodes at x = 0.1 m."""
    start, end = positions(name, *overrides)
    return float((start - end)[start[:, 0] > 0.1 - 1e-9, 2].mean())


def clamped_plate(poisson_ratio: float, stiffness: float, length: float, terms: int = 16) -> float:
    """Mean sag at the end of a clamped plate of the strip's width under its weight, by Ritz's method [m].

    Args:
        poisson_ratio: nu [1].
        stiffness: D [N m].
        length: From the clamp to the end [m].
        terms: Polynomials along the plate; those across go to degree 12.
    """
    width = 21.650635e-3
    points, weights = leggauss(2 * terms)
    square = Polynomial([0.0, 0.0, 1.0])
    along = [Legendre.basis(i, domain=[0, 1]).convert(kind=Polynomial) * square for i in range(terms)]
    across = [Legendre.basis(j).convert(kind=Polynomial) for j in range(0, 13, 2)]

    def products(shapes: list[Polynomial], x: np.ndarray, size: float) -> dict[tuple[int, int], np.ndarray]:
        """Integrals of products of derivatives of two orders."""
        slopes = [np.array([f.deriv(k)(x) if k else f(x) for f in shapes]) / size**k for k in range(3)]
        share = weights * 0.5 if size == length else weights
        return {
            (a, b): size * np.einsum("ip,jp,p->ij", slopes[a], slopes[b], share)
            for a in range(3)
            for b in range(3)
        }

    x, y = products(along, 0.5 * (points + 1.0), length), products(across, points, 0.5 * width)

    def energy(a: int, b: int, c: int, d: int) -> np.ndarray:
        return np.kron(x[a, b], y[c, d])

    matrix = energy(2, 2, 0, 0) + energy(0, 0, 2, 2) + 2.0 * (1.0 - poisson_ratio) * energy(1, 1, 1, 1)
    matrix += poisson_ratio * (energy(2, 0, 0, 2) + energy(0, 2, 2, 0))
    along_load = np.array([(0.5 * weights * f(0.5 * (points + 1.0))).sum() for f in along]) * length
    load = 1200.0 * 1e-3 * 9.81 * np.kron(along_load, np.eye(len(across))[0] * width)
    amplitudes = np.linalg.solve(stiffness * matrix, load).reshape(terms, -1)
    # only the mean across the plate counts at its end
    return float(amplitudes[:, 0] @ [f(1.0) for f in along])


@pytest.mark.parametrize("name", NAMES)
def test_builds_and_steps(name):
    loaded = scene(name)
    dt = loaded.scenario.numerics.dt
    step = dt if dt is not None else 1.0 / loaded.scenario.numerics.integrator.load_steps
    report = simulate(loaded, limits=Limits(until=2.5 * step), kernels="numpy")
    simulation, state = report.composition.simulation, report.state
    assert report.outcome.end is End.INTERRUPTED, report.message
    assert_allclose(state.t, simulation.control.grid[3], rtol=1e-12)
    assert np.abs(state.q - simulation.model.rest).max() > 0.0


def test_meshes_follow_their_formulas():
    made = runpy.run_path(str(FOLDER / "meshes" / "make.py"))
    for name, make in made["MESHES"].items():
        assert (FOLDER / "meshes" / name).read_text() == make(), name


# Cantilever plates


def test_a_plate_without_poisson_ratio_is_a_beam():
    stiffness = 2e9 * 1e-3**3 / 12.0
    assert_allclose(clamped_plate(0.0, stiffness, 0.09), BEAM, rtol=1e-9)


def test_numbers_of_the_cantilever_plates_are_those_of_plate_theory():
    stiffness = 2e9 * 1e-3**3 / 12.0
    plate = clamped_plate(0.5, stiffness / 0.75, 0.09)
    # More terms move it by 2e-5.
    assert_allclose(-scene("shell_cantilever_midedge").scenario.expect["tip"].value, plate, rtol=2e-4)
    hinges = clamped_plate(-1.0 / 3.0, stiffness, 0.09125)
    assert_allclose(-scene("shell_cantilever_hinge").scenario.expect["tip"].value, hinges, rtol=1e-3)


def test_mid_edge_normals_bend_like_a_beam_without_poisson_ratio():
    # Second order in the triangles, 1.25 mm of 90 mm; the square of the slope is smaller still.
    measured = tip("shell_cantilever_midedge", "materials.plastic.poisson_ratio=0")
    assert_allclose(measured, BEAM, rtol=1e-3)


def test_held_nodes_alone_let_the_clamp_give_way_by_half_a_triangle():
    """The code compared with holds no slope; its softer clamp hides that Poisson's ratio stiffens."""
    along = (
        "geometry[0].generate.divisions=40",
        "geometry[0].generate.length=100 mm",
        "geometry[0].generate.width=21.650635 mm",
        "geometry[0].generate.axes=[[1, 0, 0], [0, 1, 0]]",
        "motions[0].type=pin",
        "output.probes={}",
        "expect={}",
    )
    assert_allclose(tip("shell_cantilever_midedge", *along), BEAM, rtol=0.03)
    without = tip("shell_cantilever_midedge", *along, "materials.plastic.poisson_ratio=0")
    assert_allclose(without, BEAM * (91.25 / 90.0) ** 4, rtol=5e-3)


def test_hinges_are_softer_than_a_beam_and_do_not_know_poisson_ratio():
    soft = tip("shell_cantilever_hinge")
    assert BEAM < soft < 1.2 * BEAM
    # The springs of the membrane hardly matter in bending, and no other part knows the ratio.
    other = tip(
        "shell_cantilever_hinge",
        "materials.plastic.poisson_ratio=0",
        "geometry[0].membrane=springs",
        "expect={}",
    )
    assert_allclose(other, soft, rtol=1e-4)


# Parachute


def test_parachute_starts_in_free_fall():
    start, end = positions("parachute", until=0.05)
    payload = np.argmin(start[:, 2])
    # Implicit Euler falls g dt^2 (1 + 2 + ... + 5) in five steps; the air holds the canopy, and its
    # pull has hardly come down the ropes.
    assert_allclose((start - end)[payload, 2], 15.0 * 9.81e-4, rtol=1e-3)


# Jellyfish


@pytest.mark.slow
def test_the_bell_climbs_by_the_same_in_every_period_but_the_first():
    """Thrust and drag balance from the second beat on; it starts from rest, contracting at full thrust."""
    frames = simulate(scene("jellyfish")).raise_for_status().frames
    middle = np.array([frame.positions.mean(axis=0) for frame in frames])
    times = np.array([frame.t for frame in frames])
    heights = np.interp([0.0, 0.5, 1.0, 1.5, 2.0], times, middle[:, 2])
    gains = np.diff(heights)
    assert gains[0] > gains[1] > 0.03
    assert_allclose(gains[2:], gains[1], rtol=1e-5)


@pytest.mark.parametrize(("name", "start"), [("jellyfish", 0.39118), ("jellyfish_tentacles", 0.39050)])
def test_expected_heights_of_the_jellyfish_rise_in_every_period(name: str, start: float):
    """Whatever of what the tolerances allow is measured."""
    expected = [e for what, e in scene(name).scenario.expect.items() if what.startswith("height_")]
    assert [e.at for e in expected] == [0.5, 1.0, 1.5, None]
    assert all(e.tolerance.kind == "absolute" for e in expected)
    before = start
    for e in expected:
        assert e.value - e.tolerance.size > before
        before = e.value + e.tolerance.size
