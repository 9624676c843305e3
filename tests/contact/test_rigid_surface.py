"""Rigid surfaces of triangles: a box of triangles is the box, whatever its mesh; distances by sampling."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from rigid_boxes import HALF, box

from dismech_cli.arrays import FloatArray
from dismech_cli.contact.obstacles.obstacle import Rounded
from dismech_cli.contact.obstacles.rigid_surface import RigidSurface
from dismech_cli.contact.pieces.cores import BoxCore
from dismech_cli.contact.pieces.inside import inside
from dismech_cli.contact.points.points import Points


def lines(seed: int, count: int) -> tuple[FloatArray, FloatArray]:
    """Lines that stay out of the box."""
    rng = np.random.default_rng(seed)
    start = rng.normal(size=(3, 20 * count)) * 0.6
    slope = rng.normal(size=(3, 20 * count)) * 0.4
    slope[:, ::4] *= np.eye(3)[rng.integers(0, 3, 5 * count)].T
    outside = BoxCore(HALF).pieces(start, slope).nearest(20 * count) > 1e-3
    return start[:, outside][:, :count], slope[:, outside][:, :count]


def sums(points: Points, count: int) -> tuple[FloatArray, FloatArray]:
    energy, gradient = np.zeros(count), np.zeros((2, 3, count))
    np.add.at(energy, points.item, points.energy)
    np.add.at(gradient, (slice(None), slice(None), points.item), points.gradients())
    return energy, gradient


@pytest.mark.parametrize("cuts", [1, 2, 3])
def test_a_box_of_triangles_is_the_box(cuts: int) -> None:
    """Sides, edges and corners of the box; edges and corners of the mesh within a side are not felt."""
    count = 300
    start, slope = lines(1, count)
    radii, factor = np.linspace(0.05, 0.2, count), np.linspace(1.0, 2.0, count)
    surface, exact = RigidSurface.of(*box(cuts), 0.05), Rounded(BoxCore(HALF), 0.05)
    assert_allclose(surface.gaps(start, slope), exact.gaps(start, slope), atol=1e-13)
    found, wanted = (sums(one.points(start, slope, radii, factor), count) for one in (surface, exact))
    assert (wanted[0] > 0.0).sum() > 30
    assert_allclose(found[0], wanted[0], atol=1e-14)
    assert_allclose(found[1], wanted[1], atol=1e-13)


def test_the_gradient_is_that_of_the_energy() -> None:
    """From inside, through the surface and along it too."""
    rng = np.random.default_rng(2)
    count = 100
    start, slope = rng.normal(size=(3, count)) * 0.4, rng.normal(size=(3, count)) * 0.3
    surface = RigidSurface.of(*box(2), 0.0)
    radii, factor = np.full(count, 0.15), np.ones(count)

    def at(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        return sums(surface.points(x[0], x[1] - x[0], radii, factor), count)

    x = np.stack((start, start + slope))
    direction = rng.normal(size=x.shape)
    h = 1e-5
    (ahead, _), (back, _), (_, gradient) = at(x + h * direction), at(x - h * direction), at(x)
    slopes = (gradient * direction).sum(axis=(0, 1))
    assert_allclose((ahead - back) / (2.0 * h), slopes, rtol=0.0, atol=1e3 * h**2)


def test_stiffness_pushes_out_and_never_pulls() -> None:
    """Newton's method is given secants along gaps: what is taken off again leaves hardly a negative one."""
    start, slope = np.array([[-0.3], [0.01], [0.2]]), np.array([[0.5], [0.02], [0.0]])
    surface = RigidSurface.of(*box(1), 0.0)
    points = surface.points(start, slope, np.array([0.1]), np.array([1.0]))
    matrix = points.hessians().sum(axis=-1).transpose(0, 2, 1, 3).reshape(6, 6)
    least, *_, most = np.linalg.eigvalsh(matrix)
    assert most > 0.0
    assert least > -0.01 * most
    force = (points.load * points.normal).sum(axis=1)
    assert force[2] > 0.0
    assert_allclose(force[:2], 0.0, atol=1e-12 * force[2])


def test_distances_of_what_is_far_away_and_of_unlike_triangles() -> None:
    rng = np.random.default_rng(5)
    vertices, triangles = box(2)
    tiny = vertices * 1e-3 + np.array([2.0, 0.0, 0.0])
    surface = RigidSurface.of(
        np.concatenate((vertices, tiny)), np.concatenate((triangles, triangles + len(vertices))), 0.0
    )
    start, slope = rng.normal(size=(3, 50)) * 2.0, rng.normal(size=(3, 50)) * 0.2
    s, a = np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 21)
    u, v = (grid[a[:, None] + a <= 1.0 + 1e-9] for grid in np.meshgrid(a, a, indexing="ij"))
    corners = surface.vertices[surface.triangles]
    faces = corners[:, 0] + u[:, None, None] * (corners[:, 1] - corners[:, 0])
    faces = (faces + v[:, None, None] * (corners[:, 2] - corners[:, 0])).reshape(-1, 3)
    on_lines = start.T[:, None] + s[:, None] * slope.T[:, None]
    found = surface.gaps(start, slope)
    for k in range(50):
        apart = on_lines[k][:, None] - faces
        sampled = np.sqrt((apart * apart).sum(axis=2).min())
        assert found[k] <= sampled + 1e-12
        assert sampled - found[k] < 0.06


def test_inside_of_a_box() -> None:
    rng = np.random.default_rng(7)
    points = rng.uniform(-0.6, 0.6, size=(400, 3))
    vertices, triangles = box(2)
    wound = np.where(rng.random(1) < 0.5, triangles, triangles[:, ::-1])
    assert_array_equal(inside(points, vertices[wound]), (np.abs(points) < HALF).all(axis=1))


def test_an_open_surface_has_no_inside_from_far() -> None:
    vertices, triangles = box(1)
    assert not inside(np.array([[5.0, 0.0, 0.0], [0.0, 3.0, 1.0]]), vertices[triangles[2:]]).any()
