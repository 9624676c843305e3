"""Output fields of rods against closed forms, and without force where an actuator bends a free rod."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, solve
from numpy.testing import assert_allclose

from dismech_cli.output.frame import Frame

NODES = 41
MODELS: dict[str, Deck] = {
    "planar": {},
    "isotropic": {"dimension": 3},
    "framed": {"dimension": 3, "rod": {"bending": "framed"}},
}


def last(folder: Path, deck: Deck, *fields: str) -> Frame:
    """The last frame of a run with these output fields."""
    return solve(folder, deck | {"output": {"fields": list(fields)}}).frames[-1]


@pytest.mark.parametrize("model", MODELS)
def test_moments_balance_an_end_load_on_the_bent_rod(tmp_path: Path, model: str) -> None:
    """At every joint, whatever the deflection: EI 2 tan(phi/2)/l (1 + tan(phi/2)^2) = F times its lever."""
    force = {"type": "point", "where": "rod.end", "force": [0.0, 0.0, -3.0]}
    deck = rod_deck(line(NODES), given_section(bending_1=2.0), forces=[force], **MODELS[model])
    frame = last(tmp_path, deck, "curvature", "bending_moment")
    edges = np.diff(frame.positions, axis=0)
    # the wall at the first node is a joint, too, over half an edge
    angles = np.concatenate(([0.0], np.arctan2(edges[:, 2], edges[:, 0])))
    half = np.tan(0.5 * np.abs(np.diff(angles)))
    lengths = np.full(NODES - 1, 1.0 / (NODES - 1))
    lengths[0] *= 0.5
    assert angles[-1] < -0.3  # not small
    assert_allclose(frame.fields["curvature"], np.append(2.0 * half / lengths, 0.0), rtol=1e-9)
    moment = frame.fields["bending_moment"]
    assert_allclose(moment, 2.0 * frame.fields["curvature"], rtol=1e-12)
    lever = frame.positions[-1, 0] - frame.positions[:-1, 0]
    assert_allclose(moment[:-1] * (1.0 + half**2), 3.0 * lever, rtol=1e-6)


def test_a_hanging_weight_stretches_all_edges_alike(tmp_path: Path) -> None:
    force = {"type": "point", "where": "rod.end", "force": [0.0, 0.0, -2.0]}
    deck = rod_deck(line(6, (0.0, 0.0, -1.0)), given_section(axial=50.0), forces=[force])
    fields = last(tmp_path, deck, "axial_strain", "axial_force").fields
    assert_allclose(fields["axial_force"], 2.0, rtol=1e-9)
    assert_allclose(fields["axial_strain"], 0.04, rtol=1e-9)


def test_twist_is_the_angle_over_the_length_and_turns_the_directors(tmp_path: Path) -> None:
    """It grows from the clamped node to the middle of the last edge, which is turned as a whole."""
    angle, length = 2.5, 1.0 - 0.5 / (NODES - 1)
    twist = {"type": "twist", "where": "rod.end", "angle": angle}
    clamp = {"type": "clamp", "where": "rod.start"}
    deck = rod_deck(line(NODES), dimension=3, rod={"director": [0, 0, 1]}, motions=[clamp, twist])
    fields = last(tmp_path, deck, "twist", "director").fields
    assert_allclose(fields["twist"][1:-1], angle / length, rtol=1e-9)
    turned = angle / length * (np.arange(NODES - 1) + 0.5) / (NODES - 1)
    exact = np.stack((0.0 * turned, -np.sin(turned), np.cos(turned)), axis=1)
    assert_allclose(fields["director"], exact, atol=1e-9)


def test_velocities_of_free_fall(tmp_path: Path) -> None:
    numerics = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.05}
    gravity = {"type": "gravity", "acceleration": [0.0, 0.0, -9.81]}
    deck = rod_deck(line(5), forces=[gravity], motions=None, numerics=numerics)
    velocity = last(tmp_path, deck, "velocity").fields["velocity"]
    assert_allclose(velocity, np.broadcast_to([0.0, 0.0, -9.81 * 0.05], (5, 3)), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("model", "kind"),
    [
        ("planar", "curvature_1"),
        ("planar", "stretch"),
        ("framed", "curvature_1"),
        ("framed", "curvature_2"),
        ("framed", "stretch"),
    ],
)
def test_an_actuator_deforms_a_free_rod_without_force(tmp_path: Path, model: str, kind: str) -> None:
    """Forces and moments come from the elastic part of the strain alone."""
    actuation = [{"type": kind, "rod": "rod", "value": 0.1 if kind == "stretch" else 2.0}]
    deck = rod_deck(line(NODES), actuation=actuation, **MODELS[model])
    fields = last(tmp_path, deck, "axial_strain", "axial_force", "curvature", "bending_moment").fields
    assert_allclose(fields["axial_force"], 0.0, atol=1e-6 * 1e8)
    assert_allclose(fields["bending_moment"], 0.0, atol=1e-6)
    assert_allclose(fields["axial_strain"], 0.1 if kind == "stretch" else 0.0, atol=1e-6)
    assert_allclose(fields["curvature"][1:-1], 0.0 if kind == "stretch" else 2.0, rtol=1e-6, atol=1e-9)


def test_a_driven_rod_that_is_held_carries_the_force(tmp_path: Path) -> None:
    """Held at both ends it pushes with EA times what it may not lengthen, at every time of the drive."""
    pinned = [{"type": "clamp", "where": end} for end in ("rod.start", "rod.end")]
    drive = {"type": "stretch", "rod": "rod", "value": {"sine": {"amplitude": 1e-3, "frequency": 0.25}}}
    result = solve(
        tmp_path,
        rod_deck(line(6), given_section(axial=50.0), motions=pinned, actuation=[drive])
        | {"output": {"fields": ["axial_force"], "every": 0.2}},
    )
    for frame in result.frames:
        exact = -50.0 * 1e-3 * np.sin(0.5 * np.pi * frame.t)
        assert_allclose(frame.fields["axial_force"], exact, rtol=1e-9, atol=1e-12)
