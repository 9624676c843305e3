"""Material damping: decay of modes, creep and relaxation, against Kelvin and Voigt's material."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from order import observed_order

from dismech_cli.arrays import FloatArray
from dismech_cli.session.report import Report

LENGTH, RADIUS, MODULUS, DENSITY = 0.1, 2e-3, 1e6, 1000.0
BETA = 1.8751041
OMEGA = (BETA / LENGTH) ** 2 * np.sqrt(MODULUS * RADIUS**2 / (4.0 * DENSITY))


def material(time: float, **keys: Any) -> Deck:
    base = {"youngs_modulus": MODULUS, "poisson_ratio": 0.5, "density": DENSITY, "relaxation_time": time}
    return {"m": base | keys}


def first_mode(x: FloatArray) -> FloatArray:
    """Of a cantilever from 0 to 1, of unit amplitude at its tip."""
    ratio = (np.cosh(BETA) + np.cos(BETA)) / (np.sinh(BETA) + np.sin(BETA))
    y = np.cosh(BETA * x) - np.cos(BETA * x) - ratio * (np.sinh(BETA * x) - np.sin(BETA * x))
    return np.asarray(y / y[-1])


def swing(folder: Path, nodes: int, per_period: int, **keys: Any) -> tuple[FloatArray, FloatArray]:
    """Times and deflections of the tip of a cantilever let go at its rest in its first mode."""
    speed = np.zeros((nodes, 3))
    speed[:, 2] = 1e-4 * LENGTH * OMEGA * first_mode(np.linspace(0.0, 1.0, nodes))
    np.savetxt(folder / "speed.csv", speed, delimiter=",", header="x,y,z", comments="")
    dt = 2.0 * np.pi / OMEGA / per_period
    base = {
        "initial_velocity": [{"where": "rod", "velocity": {"file": "speed.csv"}}],
        "numerics": {"integrator": {"type": "tr_bdf2"}, "dt": dt, "t_end": 4.2 * per_period * dt},
        "output": {"every": dt, "probes": {"w": {"displacement": "rod.end", "component": "z"}}},
    }
    deck = rod_deck(line(nodes, (LENGTH, 0.0, 0.0)), {"type": "round", "radius": RADIUS}, **base | keys)
    result = solve(folder, deck)
    return np.array([frame.t for frame in result.frames]), scalar(result, "w")


def decrement(t: FloatArray, w: FloatArray) -> float:
    """Logarithm of the ratio of neighbouring maxima, fitted over all."""
    peaks = np.flatnonzero((np.abs(w[1:-1]) > np.abs(w[:-2])) & (np.abs(w[1:-1]) >= np.abs(w[2:]))) + 1
    a, b, c = np.abs(w[peaks - 1]), np.abs(w[peaks]), np.abs(w[peaks + 1])
    heights = b + 0.125 * (a - c) ** 2 / (2.0 * b - a - c)
    return float(-2.0 * np.polyfit(np.arange(len(heights)), np.log(heights), 1)[0])


@pytest.mark.parametrize("keys", [{}, {"dimension": 3}])
def test_decay_of_a_mode(tmp_path: Path, keys: Deck) -> None:
    """Each period leaves exp(-delta), delta = 2 pi zeta / sqrt(1 - zeta^2), zeta = omega tau / 2."""
    zeta = 0.05
    t, w = swing(tmp_path, 41, 100, materials=material(2.0 * zeta / OMEGA), **keys)
    assert_allclose(decrement(t, w), 2.0 * np.pi * zeta / np.sqrt(1.0 - zeta**2), rtol=1e-2)


TAU = 0.1
LIGHT = {"density": 1.0, "poisson_ratio": 0.3}
STATIC: Deck = {"integrator": {"type": "static", "load_steps": 1}}
CREEP: Deck = {"integrator": {"type": "tr_bdf2"}, "dt": TAU / 40, "t_end": TAU}


def pulled(nodes: int, model: str = "st_venant_kirchhoff") -> Deck:
    """A rod under a force along it."""
    rubber = {"poisson_ratio": 0.5} if model == "neo_hookean" else {}
    return rod_deck(
        line(nodes, (LENGTH, 0.0, 0.0)),
        {"type": "round", "radius": RADIUS},
        materials=material(TAU, **LIGHT | rubber | {"model": model}),
        forces=[{"type": "point", "where": "rod.end", "force": [1e-4, 0.0, 0.0]}],
        output={"every": TAU, "probes": {"u": {"displacement": "rod.end", "component": "x"}}},
    )


def twisted() -> Deck:
    """A rod under a moment about it."""
    return pulled(5) | {
        "dimension": 3,
        "forces": [{"type": "moment", "where": "rod.end", "moment": [1e-8, 0.0, 0.0]}],
        "output": {"every": TAU, "probes": {"u": {"twist": "rod"}}},
    }


def driven() -> Deck:
    """A rod whose natural length grows at once: it follows with the lag tau."""
    return pulled(5) | {"forces": [], "actuation": [{"type": "stretch", "rod": "rod", "value": 1e-4}]}


def framed(dimension: int) -> Deck:
    """Two rods at an angle, loaded at the free end."""
    deck = pulled(3) | {"dimension": dimension}
    points = [[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], [LENGTH, 0.0, LENGTH]]
    deck["geometry"][0]["generate"] = {"shape": "polyline", "points": points, "spacing": LENGTH / 5}
    deck["forces"] = [{"type": "point", "where": "rod.end", "force": [1e-7, 0.0, 0.0]}]
    return deck


def hub(dimension: int) -> Deck:
    """Three rods welded at one node, two of them loaded."""
    deck = pulled(5) | {"dimension": dimension, "joints": []}
    for name, end in (("up", LENGTH), ("down", -LENGTH)):
        branch = line(5, (1.5 * LENGTH, 0.0, end)) | {"from": [LENGTH, 0.0, 0.0]}
        deck["geometry"].append(deck["geometry"][0] | {"name": name, "generate": branch})
        deck["joints"].append({"type": "rigid", "nodes": ["rod.end", f"{name}.start"]})
    deck["forces"] = [{"type": "point", "where": "up.end", "force": [0.0, 0.0, 1e-7]}]
    deck["output"] = {"every": TAU, "probes": {"u": {"displacement": "up.end", "component": "z"}}}
    return deck


def sheet(bending: str, membrane: str, force: list[float], model: str = "st_venant_kirchhoff") -> Deck:
    """A strip clamped at its left, loaded at its right."""
    axis = "xyz"[int(np.argmax(force))]
    rubber = {"poisson_ratio": 0.5} if model == "neo_hookean" else {}
    return {
        "schema_version": 1,
        "name": "strip",
        "materials": material(TAU, **LIGHT | rubber | {"model": model}),
        "geometry": [
            {
                "type": "shell",
                "name": "rod",
                "material": "m",
                "thickness": 2e-3,
                "bending": bending,
                "membrane": membrane,
                "generate": {
                    "shape": "sheet",
                    "origin": [0.0, 0.0, 0.0],
                    "length": LENGTH,
                    "width": 0.4 * LENGTH,
                    "divisions": 6,
                    "pattern": "equilateral",
                },
            }
        ],
        "motions": [{"type": "clamp", "where": {"box": {"min": [-1, -1, -1], "max": [0.019, 1, 1]}}}],
        "forces": [{"type": "point", "where": "rod.right", "force": force}],
        "output": {"every": TAU, "probes": {"u": {"displacement": "rod.right", "component": axis}}},
    }


def leg(**joint: Any) -> Deck:
    """A rod that stands on a strip of other thickness, and is pushed aside at its end."""
    deck = sheet("midedge", "cst", ACROSS)
    stands = line(3, (0.05, 0.02, 0.05)) | {"from": [0.05, 0.02, 0.0]}
    body = {"type": "rod", "name": "leg", "material": "m", "radius": RADIUS / 4, "generate": stands}
    deck["geometry"][0]["generate"] |= {"divisions": 10, "pattern": "right"}
    deck["geometry"].append(body)
    weld = {"type": "rigid", "nodes": ["leg.start", {"nearest": [0.05, 0.02, 0.0]}]}
    push = {"type": "point", "where": "leg.end", "force": [1e-9, 1e-9, 0.0]}
    output = {"every": TAU, "probes": {"u": {"displacement": "leg.end", "component": "y"}}}
    return deck | {"joints": [weld | joint], "forces": [push], "output": output}


def seam(bending: str, axis: list[float]) -> Deck:
    """Two or three strips welded along an edge, the last loaded at its end."""
    deck = sheet(bending, "cst", ACROSS)
    first = deck["geometry"][0]
    first["generate"] |= {"pattern": "right"}
    edge = {"origin": [LENGTH, 0.0, 0.0], "length": LENGTH / 2, "divisions": 3}
    joint = {"type": "seam", "shells": ["rod", "on", "up"], "bending": "weld"}
    for name, along in (("on", [1.0, 0.0, 0.0]), ("up", axis)):
        strip = first["generate"] | edge | {"axes": [along, [0.0, 1.0, 0.0]]}
        deck["geometry"].append(first | {"name": name, "generate": strip})
    push = {"type": "point", "where": "up.right", "force": [1e-7, 0.0, 1e-7]}
    output = {"every": TAU, "probes": {"u": {"displacement": "up.right", "component": "x"}}}
    return deck | {"joints": [joint], "forces": [push], "output": output}


ACROSS, ALONG = [0.0, 0.0, 1e-7], [1e-4, 0.0, 0.0]
CREEPING = {
    "pulled": pulled(2),
    "pulled, nine nodes": pulled(9),
    "pulled rubber": pulled(5, "neo_hookean"),
    "twisted": twisted(),
    "driven": driven(),
    "planar corner": framed(2),
    "corner": framed(3),
    "planar hub": hub(2),
    "hub": hub(3),
    "midedge": sheet("midedge", "cst", ACROSS),
    "hinge": sheet("hinge", "springs", ACROSS),
    "averaged": sheet("averaged", "family", ACROSS),
    "membrane": sheet("hinge", "cst", ALONG),
    "springs": sheet("hinge", "springs", ALONG),
    "leg": leg(),
    "leg on a foot": leg(footprint=0.018),
    "seam": seam("hinge", [0.0, 0.0, 1.0]),
    "seam of normals": seam("midedge", [0.0, 0.0, 1.0]),
    "rubber membrane": sheet("hinge", "cst", ALONG, "neo_hookean"),
}


@pytest.mark.parametrize("name", CREEPING)
def test_creep(tmp_path: Path, name: str) -> None:
    """Under a sudden small load, what has no inertia to speak of goes as 1 - exp(-t/tau), on any mesh."""
    deck = CREEPING[name]
    rest = scalar(solve(tmp_path, deck | {"numerics": STATIC}), "u")[-1]
    there = scalar(solve(tmp_path, deck | {"numerics": CREEP}), "u")[-1]
    assert_allclose(there / rest, 1.0 - np.exp(-1.0), rtol=5e-3)


@pytest.mark.parametrize(
    ("integrator", "order"),
    [
        ("implicit_euler", 1.0),
        ("implicit_midpoint", 2.0),
        ("newmark", 2.0),
        ("generalized_alpha", 2.0),
        ("tr_bdf2", 2.0),
    ],
)
def test_order_in_time(tmp_path: Path, integrator: str, order: float) -> None:
    """A large swing, damped by a tenth of critical; differences of steps halved."""
    ends = []
    steps = np.array([50, 100, 200, 400])
    period = 2.0 * np.pi / OMEGA
    for count in steps:
        dt = 0.5 * period / count
        numerics = {"integrator": {"type": integrator}, "dt": dt, "t_end": 0.5 * period}
        result = swing_far(tmp_path, numerics, 0.2 / OMEGA)
        ends.append(result.frames[-1].positions[-1])
    differences = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    assert abs(observed_order(1.0 / steps[:-1], differences) - order) < 0.15


def swing_far(folder: Path, numerics: Deck, time: float, **keys: Any) -> Report:
    """A cantilever of five nodes let go under a weight that bends it by a third of its length."""
    base = {
        "materials": material(time),
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -1.0]}],
        "numerics": numerics,
        "output": {"every": numerics["t_end"] / 20},
    }
    return solve(
        folder, rod_deck(line(5, (LENGTH, 0.0, 0.0)), {"type": "round", "radius": RADIUS}, **base | keys)
    )


def test_what_damping_takes_is_booked(tmp_path: Path) -> None:
    """Kinetic, elastic and potential energy and what was dissipated keep their sum; nothing comes back."""
    period = 2.0 * np.pi / OMEGA
    numerics = {"integrator": {"type": "tr_bdf2"}, "dt": period / 200, "t_end": 3.0 * period}
    result = swing_far(tmp_path, numerics, 0.2 / OMEGA)
    lost, error = scalar(result, "dissipation"), scalar(result, "error")
    assert (np.diff(lost) >= 0.0).all()
    assert lost[-1] > 0.25 * np.abs(scalar(result, "gravitational")).max()
    assert np.abs(error).max() < 2e-3 * lost[-1]


@pytest.mark.parametrize("integrator", ["implicit_midpoint", "generalized_alpha", "tr_bdf2"])
def test_work_of_what_drives_a_damped_rod_is_booked(tmp_path: Path, integrator: str) -> None:
    """Where damping is stiff, velocities at the ends of a step ring; the account must not."""
    lift = {"expression": "0.05*smoothstep(t/0.08)"}
    deck = rod_deck(
        line(11, (0.2, 0.0, 0.0)),
        {"type": "round", "radius": 3e-3},
        materials=material(0.01),
        motions=[{"type": "clamp", "where": "rod.start", "at": "edge", "displacement": [0.0, 0.0, lift]}],
        numerics={"integrator": {"type": integrator}, "dt": 5e-3, "t_end": 0.1},
    )
    report = solve(tmp_path, deck)
    assert report.warnings == ()
    # second order in the step over the duration of the lift: (5 / 80)^2 times a number of order ten
    given = report.scalars["external_work"][-1]
    assert given > 0.0
    assert abs(report.scalars["error"][-1]) < 0.04 * given
