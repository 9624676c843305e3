"""Small deflections of plates against Kirchhoff's theory (Timoshenko & Woinowsky-Krieger)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_cases import Material, Shell, linear_solution, pressed, shell

from dismech_cli.arrays import BoolArray, FloatArray, IntArray
from dismech_cli.mesh.generate.rings import disc
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.mesh import Mesh

PLATE = Material(youngs_modulus=1.0, poisson_ratio=0.3, thickness=0.01)
BEAM = 1.0 / (1.0 - 0.3**2)  # D over E h^3 / 12
PATTERNS = (Pattern.RIGHT, Pattern.ALTERNATING, Pattern.UNSTRUCTURED, Pattern.EQUILATERAL)


def transverse(made: Shell) -> BoolArray:
    """Free DOFs of small bending: z of nodes and the mid-edge normals."""
    free = np.ones(made.model.dofs.n, dtype=bool)
    split = made.model.dofs.n_positions
    free[0:split:3] = free[1:split:3] = False
    return free


def navier(x: float, y: float) -> float:
    """Deflection D / (q a^4) of a simply supported unit square at a point, by Navier's double series."""
    m = np.arange(1, 400, 2)
    waves = np.outer(np.sin(m * np.pi * x), np.sin(m * np.pi * y))
    return float(16.0 / np.pi**6 * (waves / (np.outer(m, m) * np.add.outer(m**2, m**2) ** 2)).sum())


def supported_square(bending: str, pattern: Pattern, divisions: int) -> float:
    """Deflection of a simply supported square under uniform load, over Navier's at the same point.

    The point is the node nearest the centre, which most meshes do not have a node at.
    """
    mesh = sheet(1.0, 1.0, divisions, pattern)
    made = shell(mesh, bending, material=PLATE)
    free = transverse(made)
    free[3 * mesh.node_groups["rim"] + 2] = False
    u = linear_solution(made, free, pressed(made, 1.0))
    node = int(np.argmin(np.hypot(mesh.nodes[:, 0] - 0.5, mesh.nodes[:, 1] - 0.5)))
    return float(u[3 * node + 2]) * PLATE.rigidity / navier(mesh.nodes[node, 0], mesh.nodes[node, 1])


def order(errors: list[float]) -> float:
    """Order of convergence under halving, by regression."""
    steps = np.arange(len(errors))
    return -float(np.polyfit(steps, np.log2(np.abs(errors)), 1)[0])


def test_navier_at_the_centre_is_the_tabulated_number() -> None:
    assert_allclose(navier(0.5, 0.5), 0.0040624, atol=5e-8)


# Refined grids nest, and the next term of their error is of fourth order. Rows of equilateral triangles are
# rounded to whole ones: at 10 divisions they are 4 % lower, which is 8 % of a squared length or 0.06 of the
# order, and the share of halved triangles at two sides falls by 3/4. Random triangles differ by as much.
SCATTER = dict(zip(PATTERNS, (0.02, 0.02, 0.1, 0.1), strict=True))


def assert_second_order(pattern: Pattern, divisions: tuple[int, int, int]) -> None:
    """Too soft by less than 3.5 / n^2, which is 0.22 % at 40 divisions, and falling as that."""
    errors = np.array([supported_square("midedge", pattern, n) - 1.0 for n in divisions])
    assert (errors > 0.0).all()
    assert (errors < 3.5 / np.array(divisions) ** 2).all()
    assert_allclose(order(list(errors)), 2.0, atol=SCATTER[pattern])


@pytest.mark.parametrize("pattern", PATTERNS)
def test_midedge_converges_on_every_mesh(pattern: Pattern) -> None:
    """No preferred diagonal, no regular net needed."""
    assert_second_order(pattern, (10, 20, 40))


@pytest.mark.slow
@pytest.mark.parametrize("pattern", PATTERNS)
def test_midedge_converges_further(pattern: Pattern) -> None:
    assert_second_order(pattern, (20, 40, 80))


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
    assert_allclose(ratio, 1.0, atol=1.2 / 20**2)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_narrow_cantilever(pattern: Pattern) -> None:
    """A strip ten times longer than wide: Euler-Bernoulli's F L^3 / (3 E I) within 1 %.

    By so much the clamp stiffens it, which hinders the root's Poisson strain over about half a width.
    """
    ratio = cantilever(pattern, 40, 0.1, sides=False) * 3.0 * 0.1 * 0.01**3 / 12.0
    assert_allclose(ratio, 1.0, atol=0.01)
