"""Every corner of the range of inputs: each scene converges and is right, or gives up and names the reason.

The scenes are those of `python -m benchmarks extremes`, which makes the table of docs/extremes.md.
"""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from decks import attempt

from benchmarks.extremes.cantilever import (
    ASPECT,
    BASE,
    DENSITY,
    GRAVITY,
    MODULUS,
    RADIUS,
    SINGLE,
    cantilever,
    corners,
)
from benchmarks.extremes.cell import Cell, Kind, judged
from benchmarks.extremes.families import FAMILIES
from benchmarks.extremes.rod_balance import Rod
from benchmarks.extremes.table import KEPT, PAGE
from dismech_cli.run.loop import End

# Scenes that give up, beside those corners below: one that leaves the list has improved.
GIVE_UP = {
    "rod, L/h = 1e+08",
    "plate, L/h = 1e+08",
    "shrinks to 0.0001 L, tr_bdf2",
    "cantilever of 50001 nodes, 2D",
    "cantilever of 25001 nodes, 3D",
    "cantilever of 5001 nodes",
    "cantilever of 10001 nodes",
}
QUICK = ("single", "rest_2d", "rest_3d", "sag")
SLOW = ("single_tr_bdf2", "units", "slender", "collapsing", "control", "large")


def cells(*names: str) -> list[Cell]:
    return list(chain.from_iterable(FAMILIES[name].cells() for name in names))


def assert_right(cell: Cell) -> None:
    verdict = judged(cell)
    may_give_up = cell.label in GIVE_UP or (cell.family == "control" and "edge, p = 1" in cell.label)
    assert verdict.kind is Kind.RIGHT or (verdict.kind is Kind.NAMED and may_give_up), verdict.why


@pytest.mark.parametrize("cell", cells(*QUICK), ids=str)
def test_a_scene_is_right(cell: Cell) -> None:
    assert_right(cell)


@pytest.mark.slow
@pytest.mark.parametrize("cell", cells(*SLOW), ids=str)
def test_a_dear_scene_is_right(cell: Cell) -> None:
    assert_right(cell)


def test_forces_out_of_balance_are_seen() -> None:
    """The yardstick itself: a rod that sags as it should, and one moved by a thousandth of that."""
    rod = Rod(axial=1e4, bending=1.0, mass_per_length=1.0, length=1.0, nodes=5, gravity=1e-2)
    x = np.stack([np.linspace(0.0, 1.0, 5), np.zeros(5)], axis=1)
    for _ in range(20):
        force = (rod.forces(x) - rod.masses[:, None] * [0.0, rod.gravity])[1:].ravel()
        stiffness = np.empty((8, 8))
        for j in range(8):
            moved = x.copy()
            moved[1 + j // 2, j % 2] += 1e-6
            stiffness[:, j] = (
                force - (rod.forces(moved) - rod.masses[:, None] * [0.0, rod.gravity])[1:].ravel()
            ) / 1e-6
        x[1:] += np.linalg.solve(stiffness, force).reshape(4, 2)
    assert rod.unbalanced(x) < 1e-9
    # w L^4 / 8 EI and the error 1/n^2 of four edges
    assert x[-1, 1] == pytest.approx(-1e-2 / 8.0 * (1.0 + 1.0 / 16.0), rel=1e-3)
    x[-1, 1] *= 1.001
    assert rod.unbalanced(x) > 1e-3


def test_the_page_tells_of_every_family_and_nothing_went_wrong() -> None:
    """That the page is what the command wrote is seen from the numbers that it keeps."""
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    assert set(kept) == set(FAMILIES)
    assert not any(one["wrong"] for one in kept.values())
    text = PAGE.read_text(encoding="utf-8")
    assert all(f"`{name}`" in text for name in FAMILIES)


# Steps longer than a tenth of a pendulum's period, in which generalised-alpha makes energy: so much that
# the run ends there, or some that is told at its end.
GROWING = {("gravity", 1e3), ("dt", 0.1), ("dt", 1.0)}


@pytest.mark.slow
@pytest.mark.parametrize(("axis", "value"), SINGLE)
def test_one_extreme_input_with_little_damping(tmp_path: Path, axis: str, value: float) -> None:
    """Generalised-alpha is stable in linear motion; in falls that a step strides over it is not.

    Such a run is told by the energy that it makes. A tenth of a pendulum's period always converges.
    """
    inputs = replace(BASE, **{axis: value})
    result = attempt(tmp_path, dict(cantilever(inputs, integrator="generalized_alpha")))
    for frame in result.frames:
        assert np.isfinite(frame.positions).all()
    if (axis, value) in GROWING:
        if result.outcome.end is End.FAILED:
            assert "the motion blew up by t =" in result.outcome.message
        told = " ".join((result.outcome.message, *result.outcome.doubts))
        assert "choose tr_bdf2 or implicit_euler" in told
    else:
        assert result.outcome.end is End.DONE, result.outcome.message


# Static corners that give up, by modulus and radius: aspects. All hang under g = 1e3 m/s^2, which stretches
# them 2e5 times over and more, and of density 2e4 but for one. A corner that leaves the list has improved.
GIVEN_UP = {
    (1e2, 1e-4): {1e5},
    (1e2, 1e-3): {1e4, 1e5},
    (1e2, 1e-2): {1e3, 1e4, 1e5},
    (1e2, 1.0): {1e2, 1e3, 1e4, 1e5},
    (1e4, 1e-2): {1e5},
    (1e4, 1.0): {1e3, 1e4, 1e5},
    (1e6, 1.0): {1e5},
}
GIVEN_UP_LIGHT = (1e2, 1.0, 1e5)


def gives_up(modulus: float, radius: float, aspect: float, density: float, gravity: float) -> bool:
    """Whether a static corner is among those that are known not to converge."""
    if gravity < max(GRAVITY):
        return False
    if density < max(DENSITY):
        return (modulus, radius, aspect) == GIVEN_UP_LIGHT
    return aspect in GIVEN_UP.get((modulus, radius), ())


@pytest.mark.slow
@pytest.mark.parametrize("modulus", MODULUS)
@pytest.mark.parametrize("radius", RADIUS)
@pytest.mark.parametrize("aspect", ASPECT)
def test_every_corner(modulus: float, radius: float, aspect: float) -> None:
    """The product of the extremes of the other inputs, in time and static."""
    for cell in corners(modulus, radius, aspect):
        verdict = judged(cell)
        static = cell.family == "corner, static"
        values = dict(pair.rsplit(" ", 1) for pair in cell.label.split(", "))
        if static and gives_up(modulus, radius, aspect, float(values["density"]), float(values["gravity"])):
            assert (verdict.kind, verdict.why) == (Kind.NAMED, "factorization failed"), cell.label
        else:
            assert verdict.kind is Kind.RIGHT, f"{cell.label}: {verdict.why}"
