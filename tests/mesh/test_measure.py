"""Sizes, sides and pieces of small meshes known by hand."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.mesh.measure import (
    adjacent_areas,
    area_vectors,
    corner_angles,
    edge_lengths,
    nodal_areas,
    nodal_lengths,
    side_vectors,
    triangle_areas,
)
from dismech_cli.mesh.topology.components import components
from dismech_cli.mesh.topology.shells import rims, shell_edges
from dismech_cli.mesh.topology.sides import half_edges, rim_sides, shared_sides

EPS = np.finfo(float).eps
# A 3-4-5 triangle and its mirror image across the hypotenuse.
NODES = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0], [4.0, 3.0, 0.0]])
TRIANGLES = np.array([[0, 1, 2], [3, 2, 1]])


def test_sizes() -> None:
    assert_array_equal(edge_lengths(NODES, half_edges(TRIANGLES)), [5, 3, 4, 5, 3, 4])
    assert_array_equal(edge_lengths(NODES[:, :2], np.array([[0, 1], [1, 2]])), [4, 5])
    assert_array_equal(triangle_areas(NODES, TRIANGLES), [6, 6])
    assert_array_equal(area_vectors(NODES, TRIANGLES), [[0, 0, 6], [0, 0, 6]])
    assert_array_equal(np.linalg.norm(side_vectors(NODES, TRIANGLES), axis=2).T, [[5, 3, 4], [5, 3, 4]])


def test_corner_angles() -> None:
    angles = corner_angles(NODES, TRIANGLES)
    expected = [np.pi / 2, np.arctan2(3, 4), np.arctan2(4, 3)]
    assert_allclose(angles, np.array([expected, expected]).T, rtol=4 * EPS)


def test_shares_of_nodes() -> None:
    assert_array_equal(nodal_lengths(4, np.array([[0, 1], [1, 2]]), np.array([4.0, 5.0])), [2, 4.5, 2.5, 0])
    assert_array_equal(nodal_areas(5, TRIANGLES, np.array([6.0, 3.0])), [2, 3, 3, 1, 0])
    topology = shell_edges(TRIANGLES)
    assert_array_equal(adjacent_areas(topology.edge_faces, np.array([6.0, 3.0])), [9, 6, 6, 3, 3])


def test_sides() -> None:
    assert_array_equal(half_edges(TRIANGLES), [[1, 2], [2, 0], [0, 1], [2, 1], [1, 3], [3, 2]])
    assert [side.tolist() for side in shared_sides(TRIANGLES)] == [[0], [3]]
    assert_array_equal(rim_sides(TRIANGLES), [[2, 0], [0, 1], [1, 3], [3, 2]])
    assert rims(TRIANGLES) == 1
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert rim_sides(tetrahedron).size == 0
    assert rims(tetrahedron) == 0


def test_components() -> None:
    number, label = components(6, np.array([[4, 1], [2, 5], [1, 0]]))
    assert number == 3
    assert label.tolist() == [0, 0, 1, 2, 0, 1]
    assert components(0, np.empty((0, 2), dtype=np.int64))[0] == 0
