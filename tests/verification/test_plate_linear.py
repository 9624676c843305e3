"""Small deflections of plates against Kirchhoff's theory (Timoshenko & Woinowsky-Krieger)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_cases import Material, Shell, linear_solution, pressed, shell

from dismech_cli.arrays import BoolArray, FloatArray, IntArray
from dismech_cli.mesh.generate_shell import Pattern, disc, sheet
from dismech_cli.mesh.mesh import Mesh

PLATE = Material(youngs_modulus=1.0, poisson_ratio=0.3, thickness=0.01)
BEAM = 1.0 / (1.0 - 0.3**2)  # D over E h^3 / 12
# Navier's double series for a simply supported square: center deflection D / (q a^4)
NAVIER = 0.004062353
PATTERNS = (Pattern.RIGHT, Pattern.ALTERNATING, Pattern.UNSTRUCTURED, Pattern.EQUILATERAL)


def transverse(made: Shell) -> BoolArray:
    """Free DOFs of small bending: z of nodes and the mid-edge normals."""
    free = np.ones(made.model.dofs.n, dtype=bool)
    split = made.model.dofs.n_positions
    free[0:split:3] = free[1:split:3] = False
    return free


def supported_square(bending: str, pattern: Pattern, divisions: int) -> float:
    """Largest deflection of a simply supported square under uniform load, over Navier's."""
    mesh = sheet(1.0, 1.0, divisions, pattern)
    made = shell(mesh, bending, material=PLATE)
    free = transverse(made)
    free[3 * mesh.node_groups["rim"] + 2] = False
    u = linear_solution(made, free, pressed(made, 1.0))
    return float(u[2 : made.model.dofs.n_positions : 3].max()) * PLATE.rigidity / NAVIER


def order(errors: list[float]) -> float:
    """Order of convergence under halving, by regression."""
    steps = np.arange(len(errors))
    return -float(np.polyfit(steps, np.log2(np.abs(errors)), 1)[0])


@pytest.mark.parametrize("pattern", PATTERNS)
def test_midedge_converges_on_every_mesh(pattern: Pattern) -> None:
    """Second order, and within 1 % at 40 divisions: no preferred diagonal, no regular net needed."""
    errors = [supported_square("midedge", pattern, n) - 1.0 for n in (10, 20, 40)]
    for n, error in zip((10, 20, 40), errors, strict=True):
        assert 0.0 < error < 4.0 / n**2
    if pattern in (Pattern.RIGHT, Pattern.ALTERNATING):  # nested meshes: a clean order
        assert_allclose(order(errors), 2.0, atol=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("pattern", PATTERNS)
def test_midedge_converges_further(pattern: Pattern) -> None:
    """Six hundredths of a per cent at 80 divisions."""
    assert_allclose(supported_square("midedge", pattern, 80), 1.0, atol=4.0 / 80**2)


@pytest.mark.parametrize(
    ("hinges", "pattern", "ratio"),
    [
        ("hinge", Pattern.EQUILATERAL, 1.0),
        ("hinge", Pattern.RIGHT, 0.713),
        ("hinge", Pattern.ALTERNATING, 1.155),
        ("weighted", Pattern.EQUILATERAL, 1.0),
        ("weighted", Pattern.RIGHT, 0.556),
        ("weighted", Pattern.ALTERNATING, 0.744),
    ],
)
def test_hinges_are_a_plate_on_equilateral_nets_only(hinges: str, pattern: Pattern, ratio: float) -> None:
    """Against the plate of rigidity E h^3 / 12: equal or weighted, they converge, but to another plate."""
    coarse, fine = (supported_square(hinges, pattern, n) / BEAM for n in (20, 40))
    # the remaining error of second order is extrapolated; a rim row of halved triangles adds 0.1 %
    assert_allclose(fine + (fine - coarse) / 3.0, ratio, rtol=3e-3)


@pytest.mark.parametrize(
    ("pattern", "low", "high"),
    [(Pattern.EQUILATERAL, 0.995, 1.005), (Pattern.RIGHT, 0.96, 0.99), (Pattern.ALTERNATING, 0.58, 0.63)],
)
def test_averaged_normals_lock_on_irregular_nets(pattern: Pattern, low: float, high: float) -> None:
    """Good on equilateral triangles; where diagonals alternate, twisting is shut out."""
    assert low < supported_square("averaged", pattern, 40) < high


def clamped_disc(bending: str, rings: int) -> float:
    """Largest deflection of a clamped disc under uniform load, over q a^4 / (64 D).

    A rim is clamped by holding its nodes and its mid-edge normals, or, without normals, by a second
    row of nodes held outside it.
    """
    outside = 0 if bending == "midedge" else 1
    mesh = disc(1.0 + outside / rings, rings + outside)
    made = shell(mesh, bending, material=PLATE)
    free = transverse(made)
    radius = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1])
    free[3 * np.flatnonzero(radius > 1.0 - 1e-9) + 2] = False
    if bending == "midedge":
        free[made.model.dofs.of_normals(made.rim_edges())] = False
    u = linear_solution(made, free, pressed(made, 1.0))
    return float(u[2 : made.model.dofs.n_positions : 3].max()) * 64.0 * PLATE.rigidity


def test_clamped_disc() -> None:
    """Second order, rim clamped through its edge normals; 0.4 % with 32 rings."""
    errors = [clamped_disc("midedge", rings) - 1.0 for rings in (8, 16, 32)]
    assert 0.0 < errors[-1] < 5e-3
    assert_allclose(order(errors), 2.0, atol=0.1)


def tip(mesh: Mesh) -> tuple[IntArray, FloatArray]:
    """Nodes of the right side and their shares of its length."""
    nodes = mesh.node_groups["right"]
    nodes = nodes[np.argsort(mesh.nodes[nodes, 1])]
    gaps = np.diff(mesh.nodes[nodes, 1])
    shares = np.zeros(len(nodes))
    shares[:-1] += 0.5 * gaps
    shares[1:] += 0.5 * gaps
    return nodes, shares / shares.sum()


def cantilever(pattern: Pattern, divisions: int, width: float, *, sides: bool) -> float:
    """Mean deflection of the tip under a unit force spread over it; length 1.

    ``sides`` holds the edge normals of the long sides, as symmetry does in an infinitely wide plate.
    """
    mesh = sheet(1.0, width, divisions, pattern)
    made = shell(mesh, "midedge", material=PLATE)
    dofs, nodes = made.model.dofs, mesh.nodes
    free = transverse(made)
    held = [nodes[:, 0] == 0.0]
    free[3 * np.flatnonzero(held[0]) + 2] = False
    if sides:
        held += [nodes[:, 1] == 0.0, nodes[:, 1] == width]
    for group in held:
        free[dofs.of_normals(made.edges_among(group))] = False
    ends, shares = tip(mesh)
    force = np.zeros(dofs.n)
    force[3 * ends + 2] = shares
    return float(linear_solution(made, free, force)[3 * ends + 2] @ shares)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_wide_cantilever(pattern: Pattern) -> None:
    """Cylindrical bending: F L^3 / (3 D b), stiffer than a beam by 1 / (1 - nu^2)."""
    ratio = cantilever(pattern, 20, 1.0, sides=True) * 3.0 * PLATE.rigidity
    assert_allclose(ratio, 1.0, atol=0.01)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_narrow_cantilever(pattern: Pattern) -> None:
    """A strip ten times longer than wide: Euler-Bernoulli's F L^3 / (3 E I) within 2 %.

    The clamp hinders the root's Poisson strain over about half a width, which stiffens by 1 %.
    """
    ratio = cantilever(pattern, 40, 0.1, sides=False) * 3.0 * 0.1 * 0.01**3 / 12.0
    assert_allclose(ratio, 1.0, atol=0.02)
