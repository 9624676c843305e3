"""Drag in wind and current: Galilean invariance, slender rods in shear, bending by a stream."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, scalar, solve, tip
from numpy.testing import assert_allclose
from shell_decks import DOWN, shell_deck

from dismech_cli.errors import ScenarioError

WIND = 1.7
"""Speed of the rising air [m/s]."""


def canopy(wind: list[Any] | None, speed: float) -> Deck:
    """A soft disc that falls face down along a guide, which keeps it from fluttering."""
    drag: Deck = {"type": "aerodynamic", "fluid_density": 1.2, "coefficient": 1.5}
    if wind is not None:
        drag["fluid_velocity"] = wind
    return shell_deck(
        {"shape": "disc", "center": [0.0, 0.0, 0.0], "radius": 0.2, "rings": 4},
        body={"bending": "hinge", "thickness": 5e-4},
        forces=[DOWN, drag],
        motions=[{"type": "pin", "where": "sheet", "components": ["x", "y"]}],
        # heavier in the middle: it must fill
        masses=[{"where": {"nearest": [0.0, 0.0, 0.0]}, "mass": 0.01}],
        initial_velocity=[{"where": "sheet", "velocity": [0.0, 0.0, speed]}],
        numerics={
            "integrator": {"type": "tr_bdf2"},
            "dt": 0.02,
            "t_end": 8.0,
            "newton": {"tolerance": 1e-11},
        },
        output={"every": 0.5, "fields": ["velocity"]},
    )


@pytest.mark.parametrize("rest", [False, True], ids=["carried", "from rest"])
def test_a_parachute_in_an_updraught(tmp_path: Path, rest: bool) -> None:
    """The fall in still air, seen from the rising air: to 1e-8 all the way, or in the end."""
    still = solve(tmp_path, canopy(None, 0.0))
    rising = solve(tmp_path, canopy([0.0, 0.0, WIND], 0.0 if rest else WIND))
    for a, b in list(zip(still.frames, rising.frames, strict=True))[-1 if rest else 0 :]:
        shift = np.array([0.0, 0.0, WIND])
        assert_allclose(b.fields["velocity"] - shift, a.fields["velocity"], atol=1e-8)
        if not rest:
            assert_allclose(b.positions - b.t * shift, a.positions, atol=1e-8)
    last = still.frames[-1]
    # terminal: what falls no faster any more, at the speed of a filled canopy, more than a flat one
    mass = 1000.0 * np.pi * 0.04 * 5e-4 + 0.01
    flat = np.sqrt(2.0 * mass * 9.81 / (1.2 * 1.5 * np.pi * 0.04))
    assert 1.0 < -last.fields["velocity"][0, 2] / flat < 2.0
    # the drag's work is booked where the air moves: the account closes as well
    share = abs(rising.frames[-1].scalars["error"]) / abs(rising.frames[-1].scalars["gravitational"])
    assert share < 1e-2


@pytest.mark.parametrize("kernels", ["numpy", "numba"])
def test_a_slender_rod_turns_in_shear(tmp_path: Path, kernels: str) -> None:
    """Free and without inertia, in u = gamma z e_x: cot phi = cot phi_0 + gamma t (Jeffery, thin limit)."""
    gamma, angle = 2.0, 1.9
    end = [np.cos(angle), 0.0, np.sin(angle)]
    mass = 1e-5
    drag = {"type": "resistive", "tangential": 0.7, "normal": 1.3, "fluid_velocity": ["0", "0", "0"]}
    drag["fluid_velocity"] = [{"expression": f"{gamma}*z"}, 0.0, 0.0]
    deck = rod_deck(
        line(6, end),
        given_section(axial=1e5, mass_per_length=mass),
        motions=[],
        forces=[drag],
        numerics={"integrator": {"type": "tr_bdf2"}, "dt": 0.005, "t_end": 1.0, "kernels": kernels},
        output={"every": 0.25},
    )
    result = solve(tmp_path, deck)
    for frame in result.frames[1:]:
        x = frame.positions[-1] - frame.positions[0]
        # the mass lags by m / c, steps of gamma dt = 0.01 err by its square
        assert_allclose(x[0] / x[2], 1.0 / np.tan(angle) + gamma * frame.t, atol=2e-4)
    centre = result.frames[-1].positions.mean(axis=0)
    # a straight free rod goes with the fluid at its middle, which drifts at its height
    assert_allclose(centre[2], 0.5 * end[2], atol=1e-4)
    assert_allclose(centre[0], 0.5 * end[0] + gamma * 0.5 * end[2], atol=1e-3)


@pytest.mark.parametrize(("speed", "factor"), [(2e-5, 1 / 8), ("2e-5*x", 11 / 120)])
def test_a_cantilever_bent_by_a_stream(tmp_path: Path, speed: Any, factor: float) -> None:
    """Statics under a steady stream: f = eta u per length, uniform or growing along the rod."""
    across = {"expression": speed} if isinstance(speed, str) else speed
    drag = {"type": "viscous", "coefficient": 3.0, "fluid_velocity": [0.0, 0.0, across]}
    result = solve(tmp_path, rod_deck(line(81), forces=[drag]))
    # second order in the 80 edges, EI = L = 1
    assert_allclose(tip(result)[2], 6e-5 * factor, rtol=5e-4)


def test_work_of_a_current(tmp_path: Path) -> None:
    """A free rod in a sudden current: it takes m u^2 / 2, the stream gives m u^2, and half becomes heat."""
    drag = {"type": "viscous", "coefficient": 5.0, "fluid_velocity": [0.8, 0.0, 0.3]}
    numerics = {"integrator": {"type": "newmark"}, "dt": 0.005, "t_end": 8.0}
    result = solve(tmp_path, rod_deck(line(5), motions=[], forces=[drag], numerics=numerics))
    half = 0.5 * (0.8**2 + 0.3**2)
    kinetic, work = scalar(result, "kinetic")[-1], scalar(result, "external_work")[-1]
    assert_allclose(kinetic, half, rtol=1e-6)
    # what the drag does on the rod, heat already taken off; second order in dt c / m = 0.025
    assert_allclose(work, half, rtol=1e-3)


@pytest.mark.parametrize(
    ("velocity", "message"),
    [
        (
            [{"expression": "log(z)"}, 0.0, 0.0],
            "'log(z)' has no finite value or slope at t = 0 s and (0, 0, 0) m",
        ),
        ([{"expression": "s"}, 0.0, 0.0], "'s' has no meaning here; known: 't', 'x', 'y' or 'z'"),
        ([0.0, 1.0, 0.0], "has a part in y, out of the plane of the scene"),
        ([{"expression": "sawtooth(t, x)"}, 0.0, 0.0], "the width of a sawtooth depends on x here"),
        (["1 m", 0.0, 0.0], "expected a velocity"),
    ],
)
def test_flows_that_are_refused(tmp_path: Path, velocity: list[Any], message: str) -> None:
    drag = {"type": "viscous", "coefficient": 5.0, "fluid_velocity": velocity}
    numerics = {"integrator": {"type": "newmark"}, "dt": 0.005, "t_end": 0.01}
    with pytest.raises(ScenarioError, match=re.escape(message)):
        solve(tmp_path, rod_deck(line(5), motions=[], forces=[drag], numerics=numerics))


def test_stability_under_a_stream_is_not_asked_of_signs(tmp_path: Path) -> None:
    drag = {"type": "viscous", "coefficient": 5.0, "fluid_velocity": [1.0, 0.0, 0.0]}
    output = {"probes": {"n": {"negative_eigenvalues": True}}}
    with pytest.raises(ScenarioError, match="moving fluids make the stiffness unsymmetric"):
        solve(tmp_path, rod_deck(line(5), forces=[drag], output=output))
