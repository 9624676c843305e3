"""Loads at which the stiffness loses its positive definiteness, by bisection on the stability probe.

Sources: Euler columns (classical), Greenhill 1881 and 1883 (self weight, twist), Michell 1889 and
Zajac 1962 (ring), Romero et al. 2021 (lateral buckling). All stiffnesses and lengths are 1 unless
they are what is studied.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, critical_load, given_section, line, negative_eigenvalues, rod_deck, solve
from numpy.testing import assert_allclose
from order import observed_order

ONE_STEP: Deck = {"integrator": {"type": "static", "load_steps": 1}}
AXIAL = 1e6
CLAMP_START: Deck = {"type": "clamp", "where": "rod.start"}
PIN_START: Deck = {"type": "pin", "where": "rod.start"}
SLIDING_PIN: Deck = {"type": "pin", "where": "rod.end", "components": ["z"]}

Family = Callable[[int, float], Deck]


def straight(nodes: int, **keys: Any) -> Deck:
    section = keys.pop("section", given_section(axial=AXIAL))
    return rod_deck(line(nodes), section, numerics=ONE_STEP, **keys)


def pushed(*motions: Deck) -> Family:
    """Columns under an end force."""

    def deck(nodes: int, load: float) -> Deck:
        force = {"type": "point", "where": "rod.end", "force": [-load, 0.0, 0.0]}
        return straight(nodes, motions=list(motions), forces=[force])

    return deck


def squeezed(nodes: int, load: float) -> Deck:
    """A column between two clamps, the second moved inwards."""
    second = {"type": "clamp", "where": "rod.end", "displacement": [-load / AXIAL, 0.0, 0.0]}
    return straight(nodes, motions=[CLAMP_START, second])


def heavy_column(nodes: int, load: float) -> Deck:
    return straight(nodes, forces=[{"type": "gravity", "acceleration": [-load, 0.0, 0.0]}])


def heavy_strip(nodes: int, load: float) -> Deck:
    """A cantilever standing on edge: stiff in the plane of its weight, soft across it."""
    return straight(
        nodes,
        section=given_section(axial=1e8, bending_1=1.0, bending_2=1e4, torsion=1.0),
        rod={"director": [0.0, 1.0, 0.0]},
        dimension=3,
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -load]}],
    )


def twisted_between_clamps(nodes: int, load: float) -> Deck:
    second = {"type": "clamp", "where": "rod.end", "twist": load}
    return straight(nodes, dimension=3, motions=[CLAMP_START, second])


def ring(curvature: Deck) -> Family:
    """Unit rings that want to twist by ``load`` more than they can; only rigid motion is held."""

    def node(index: int) -> Deck:
        return {"nodes": {"of": "rod", "indices": [index]}}

    def deck(nodes: int, load: float) -> Deck:
        motions: list[Deck] = [
            {"type": "pin", "where": node(0)},
            {"type": "pin", "where": node(nodes // 2), "components": ["y", "z"]},
            {"type": "pin", "where": node(nodes // 4), "components": ["z"]},
            {"type": "twist", "where": {"edges": {"of": "rod", "indices": [0]}}, "angle": 0.0},
        ]
        circle = {
            "shape": "arc",
            "center": [0.0, 0.0, 0.0],
            "radius": 1.0,
            "normal": [0.0, 0.0, 1.0],
            "start": [1.0, 0.0, 0.0],
            "angle": 2.0 * np.pi,
            "nodes": nodes,
            "closed": True,
        }
        natural = curvature | {"twist": load / (2.0 * np.pi)}
        return rod_deck(
            circle,
            given_section(axial=AXIAL),
            rod={"natural": natural},
            dimension=3,
            motions=motions,
            numerics=ONE_STEP,
        )

    return deck


def circular_ring_threshold(torsion: float = 1.0) -> float:
    """Twist angle at which a naturally circular ring leaves its plane.

    The linearised Kirchhoff equations about a unit ring with torque M and no bending moment have, for
    n waves, the two rows -(1 + g n^2) a = i n (1 + g) p and M^2 p + i n (1 + g) a = (n^2 + g) p, with g
    the torsional stiffness, a the rotation of the section and p that about the normal. With the bending
    moment of a naturally straight ring the same steps give Michell's M^2 = n^2 - 1.
    """
    g, n = torsion, np.arange(2, 10)
    squares = n**2 + g - n**2 * (1.0 + g) ** 2 / (1.0 + g * n**2)
    return float(2.0 * np.pi * np.sqrt(squares.min()) / g)


# name: decks, exact load, tolerance at 101 nodes (100 for rings); the load P of a column errs by P h^2/12 EI
CASES: dict[str, tuple[Family, float, float]] = {
    "fixed-free": (pushed(CLAMP_START), 2.467401, 5e-4),
    "pinned": (pushed(PIN_START, SLIDING_PIN), 9.869604, 5e-4),
    "fixed-pinned": (pushed(CLAMP_START, SLIDING_PIN), 20.190729, 5e-4),
    "fixed-fixed": (squeezed, 39.478418, 5e-4),
    "self weight": (heavy_column, 7.837347, 5e-4),
    "lateral": (heavy_strip, 12.853763, 1e-3),
    "twist between clamps": (twisted_between_clamps, 8.986819, 2e-3),
    "straight ring": (
        ring({"curvature_1": 0.0, "curvature_2": 0.0}),
        2.0 * np.pi * np.sqrt(3.0),
        5e-3,
    ),
    "circular ring": (ring({}), circular_ring_threshold(), 5e-3),
}


def threshold(folder: Path, name: str, nodes: int, bracket: float, relative: float) -> float:
    """Critical load over the exact one."""
    family, exact, _ = CASES[name]

    def stable(ratio: float) -> bool:
        return negative_eigenvalues(folder, family(nodes, ratio * exact)) == 0

    return critical_load(stable, 1.0 - bracket, 1.0 + bracket, relative)


@pytest.mark.parametrize("name", CASES)
def test_critical_load(tmp_path: Path, name: str) -> None:
    """Stable one tolerance below the exact load, unstable one above."""
    family, exact, tolerance = CASES[name]
    nodes = 100 if "ring" in name else 101
    assert negative_eigenvalues(tmp_path, family(nodes, (1.0 - tolerance) * exact)) == 0
    assert negative_eigenvalues(tmp_path, family(nodes, (1.0 + tolerance) * exact)) > 0


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name == "pinned" else pytest.mark.slow)
        for name in CASES
        if name != "lateral"  # its limit is that of an infinite stiffness in the plane, see below
    ],
)
def test_critical_load_converges_at_second_order(tmp_path: Path, name: str) -> None:
    nodes = np.array([20, 40, 80] if "ring" in name else [21, 41, 81])
    errors = np.array([threshold(tmp_path, name, n, 0.15, 1e-5) - 1.0 for n in nodes])
    assert observed_order(1.0 / (nodes - nodes[0] % 2), np.abs(errors)) > 1.8


@pytest.mark.slow
def test_lateral_buckling_converges_at_second_order(tmp_path: Path) -> None:
    """Differences of meshes, as the exact load is that of an infinite stiffness in the plane."""
    a, b, c = (threshold(tmp_path, "lateral", n, 0.05, 1e-7) for n in (21, 41, 81))
    assert np.log2((a - b) / (b - c)) > 1.8


def test_count_of_unstable_modes(tmp_path: Path) -> None:
    """Beyond the k-th Euler load of a pinned column k modes are unstable, in either plane of space."""
    family = CASES["pinned"][0]
    for modes in (1, 2, 3):
        load = 1.05 * (modes * np.pi) ** 2
        assert negative_eigenvalues(tmp_path, family(101, load)) == modes
    solid = family(101, 1.05 * np.pi**2) | {
        "dimension": 3,
        "motions": [PIN_START, SLIDING_PIN | {"components": ["y", "z"]}],
    }
    assert negative_eigenvalues(tmp_path, solid) == 2


def test_twisted_pinned_rod(tmp_path: Path) -> None:
    """Greenhill's rod with axial torques on pinned ends: its answer to a small force grows beyond bounds.

    Torques of fixed direction make the stiffness unsymmetric, so that eigenvalues cannot be counted; the
    inverse of the deflection falls linearly to zero at the critical torque, M L/EI = 2 pi (Southwell).
    """
    exact = 2.0 * np.pi
    loads = exact * np.array([0.90, 0.93, 0.96])
    compliance = []
    for load in loads:
        torque = [float(load), 0.0, 0.0]
        deck = straight(
            101,
            dimension=3,
            motions=[PIN_START, SLIDING_PIN | {"components": ["y", "z"]}],
            forces=[
                {"type": "moment", "where": "rod.end", "moment": torque},
                {"type": "moment", "where": "rod.start", "moment": [-float(load), 0.0, 0.0]},
                {"type": "distributed", "force_per_length": [0.0, 0.0, 1e-2]},
            ],
        )
        middle = solve(tmp_path, deck).frames[-1].positions[50]
        compliance.append(np.hypot(middle[1], middle[2]))
    slope, offset = np.polyfit(loads, 1.0 / np.array(compliance), 1)
    assert_allclose(-offset / slope, exact, rtol=5e-3)
