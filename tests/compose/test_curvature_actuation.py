"""Driven curvature of shells: natural angles, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_decks import SHEET, Deck, made, ran, refused, shell_deck, write

from dismech_cli.kinematics.strains import angles_of_curvature
from dismech_cli.laws.signal import NO_INPUTS
from dismech_cli.model.driven import DrivenEnergy

__all__ = ["made", "ran", "refused", "write"]

STATIC: Deck = {"integrator": {"type": "static", "load_steps": 2}}


def curved(**keys: Any) -> Deck:
    return {"type": "surface_curvature", "shell": "sheet", "along": [1.0, 0.0, 0.0], "value": 1.0} | keys


@pytest.mark.parametrize(("bending", "angles"), [("midedge", 1.0), ("averaged", 2.0)])
def test_natural_angles_are_those_of_the_curvature(made: Any, bending: str, angles: float) -> None:
    """Laws of place and time, both directions, a part of the sheet; a direction is laid into the sheet."""
    half = {"box": {"min": [0.0, 0.0, 0.0], "max": [0.15, 0.2, 0.0]}}
    law = {"expression": "t*x + y"}
    part = curved(along=[3.0, 4.0, 7.0], value=law, across=-0.5, where=half)
    built = made(shell_deck(body={"bending": bending}, actuation=[part]))
    geometry = built.geometry
    (driven,) = (t for t in built.simulation.model.terms if isinstance(t, DrivenEnergy))
    added = np.zeros_like(driven.energy.natural)
    for drive in driven.drives:
        added[drive.row, drive.stencils] += drive.factors * drive.signal.value(2.0, NO_INPUTS, drive.places)
    x = geometry.nodes[geometry.triangles]
    inside = (x[:, :, 0] <= 0.15 + 1e-12).all(axis=1)
    assert 0 < inside.sum() < len(inside)
    middle = x.mean(axis=1)
    along, across = np.array([0.6, 0.8, 0.0]), np.array([-0.8, 0.6, 0.0])
    size = 2.0 * middle[:, 0] + middle[:, 1]
    tensor = size[:, None, None] * np.outer(along, along) - 0.5 * np.outer(across, across)
    expected = np.where(
        inside, -angles * angles_of_curvature(geometry.nodes, geometry.triangles, tensor), 0.0
    )
    assert_allclose(added, expected, atol=1e-14)


@pytest.mark.parametrize("bending", ["midedge", "averaged"])
def test_a_free_sheet_takes_its_curvature_without_energy(ran: Any, bending: str) -> None:
    """Developable: it bends toward its normals into a cylinder; a triangle as wide as its arc leaves 1 %."""
    kappa = 2.0
    deck = shell_deck(
        SHEET | {"pattern": "equilateral", "divisions": 8},
        body={"bending": bending},
        motions=[
            {"type": "clamp", "where": "sheet.left"}
            if bending == "midedge"
            else {"type": "pin", "where": {"box": {"min": [0.0, 0.0, 0.0], "max": [0.04, 0.2, 0.0]}}}
        ],
        actuation=[curved(value=kappa)],
        numerics=STATIC,
    )
    result = ran(deck)
    last, start = result.frames[-1].positions, result.frames[0].positions
    flat = 0.0 if bending == "midedge" else start[start[:, 0] <= 0.04 + 1e-9, 0].max()
    s = np.maximum(start[:, 0] - flat, 0.0)
    assert_allclose(last[:, 2], (1.0 - np.cos(kappa * s)) / kappa, atol=0.03 * 0.3)
    assert last[:, 2].max() > 0.05


@pytest.mark.parametrize(
    ("keys", "bending", "message"),
    [
        ({}, "hinge", "actuation[0].shell: bending 'hinge' of 'sheet' knows no curvature"),
        ({"along": [0.0, 0.0, 2.0]}, "midedge", "actuation[0].along: stands normal to a triangle of shell"),
        ({"where": "sheet.left"}, "midedge", "actuation[0].where: holds no whole triangle of shell 'sheet'"),
        ({"shell": "shet"}, "midedge", "actuation[0].shell: no shell is named 'shet'; did you mean"),
        ({"value": {"expression": "s"}}, "midedge", "'s'"),
    ],
)
def test_refusals(refused: Any, keys: Deck, bending: str, message: str) -> None:
    assert message in refused(shell_deck(body={"bending": bending}, actuation=[curved(**keys)]))
