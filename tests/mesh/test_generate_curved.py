"""Rolled and bent sheets: on their surface, wound outward, closed where they go all around."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.generate.curved import cylinder, sphere
from dismech_cli.mesh.generate.sheets import Pattern
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.mesh.topology.shells import shell_edges

SIDES = ("left", "right", "bottom", "top")


def area_vectors(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.nodes[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def rim(mesh: Mesh) -> np.ndarray:
    shell = shell_edges(mesh.triangles)
    return np.unique(shell.edges[shell.edge_faces[:, 1] < 0])


def euler(mesh: Mesh) -> int:
    return len(mesh.nodes) - len(shell_edges(mesh.triangles).edges) + len(mesh.triangles)


@pytest.mark.parametrize("pattern", Pattern)
def test_panels_of_cylinders(pattern: Pattern) -> None:
    mesh = cylinder(2.0, 3.0, np.pi / 2, 12, pattern)
    x, y, z = mesh.nodes.T
    assert_allclose(np.hypot(x, y), 2.0, rtol=1e-15)
    groups = mesh.node_groups
    for name, values, place in (("left", z, 0.0), ("right", z, 3.0), ("bottom", y, 0.0), ("top", x, 0.0)):
        assert_allclose(values[groups[name]], place, rtol=1e-15, atol=1e-15)
        assert len(groups[name]) > 4
    assert_array_equal(rim(mesh), groups["rim"])
    assert_array_equal(np.unique(np.concatenate([groups[side] for side in SIDES])), groups["rim"])
    centers = mesh.nodes[mesh.triangles].mean(axis=1) * [1.0, 1.0, 0.0]
    assert (np.einsum("ij,ij->i", area_vectors(mesh), centers) > 0.0).all()
    # Facets lie inside: their area is smaller, by (step / radius)^2 / 24 where they go along the arc.
    area = np.linalg.norm(area_vectors(mesh), axis=1).sum()
    assert_allclose(area, 3.0 * np.pi, rtol=(0.25 / 2.0) ** 2 / 8.0)
    assert euler(mesh) == 1


@pytest.mark.parametrize("pattern", Pattern)
def test_tubes_have_no_seam(pattern: Pattern) -> None:
    mesh = cylinder(1.0, 3.0, 2.0 * np.pi, 10, pattern)
    assert euler(mesh) == 0
    assert_array_equal(rim(mesh), mesh.node_groups["rim"])
    assert_array_equal(mesh.node_groups["bottom"], mesh.node_groups["top"])
    # A closed surface but for its two mouths, whose area vectors cancel.
    assert_allclose(area_vectors(mesh).sum(axis=0), 0.0, atol=1e-12)


def test_equilateral_tubes_close_with_an_even_number_of_rows_only() -> None:
    # 2 pi / (3/7 sqrt(3)/2) = 16.9 rows
    with pytest.raises(MeshError, match="odd number of rows"):
        cylinder(1.0, 3.0, 2.0 * np.pi, 7)


@pytest.mark.parametrize("pattern", Pattern)
def test_zones_of_spheres(pattern: Pattern) -> None:
    polar = (np.pi / 10, np.pi / 2)
    quarter, ring = (sphere(10.0, polar, angle, 8, pattern) for angle in (np.pi / 2, 2.0 * np.pi))
    for mesh, holes in ((quarter, 1), (ring, 0)):
        assert_allclose(np.linalg.norm(mesh.nodes, axis=1), 10.0, rtol=1e-15)
        assert_allclose(mesh.nodes[mesh.node_groups["left"], 2], 10.0 * np.cos(np.pi / 10), rtol=1e-15)
        assert_allclose(mesh.nodes[mesh.node_groups["right"], 2], 0.0, atol=1e-14)
        assert_allclose(mesh.nodes[mesh.node_groups["bottom"], 1], 0.0, atol=1e-14)
        centers = mesh.nodes[mesh.triangles].mean(axis=1)
        assert (np.einsum("ij,ij->i", area_vectors(mesh), centers) > 0.0).all()
        assert euler(mesh) == holes
        assert_array_equal(rim(mesh), mesh.node_groups["rim"])
    assert_allclose(quarter.nodes[quarter.node_groups["top"], 0], 0.0, atol=1e-14)


@pytest.mark.parametrize(
    ("polar", "angle", "message"),
    [
        ((0.0, 1.0), 1.0, "polar angles"),
        ((1.0, 1.0), 1.0, "polar angles"),
        ((1.0, 3.2), 1.0, "polar angles"),
        ((0.5, 1.0), 0.0, "at most a full turn"),
        ((0.5, 1.0), 6.3, "at most a full turn"),
    ],
)
def test_angles_out_of_range(polar: tuple[float, float], angle: float, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        sphere(1.0, polar, angle, 4)
    if "full turn" in message:
        with pytest.raises(MeshError, match=message):
            cylinder(1.0, 1.0, angle, 4)
