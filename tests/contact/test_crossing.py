"""The look at frames: edges through triangles."""

from __future__ import annotations

import numpy as np

from dismech_cli.contact.crossing import crossings


def test_random_edges_and_triangles_against_a_linear_solve() -> None:
    rng = np.random.default_rng(3)
    x = rng.uniform(size=(120, 3))
    edges = np.arange(60).reshape(30, 2)
    triangles = np.arange(60, 120).reshape(20, 3)
    expected = []
    for i, (p, q) in enumerate(x[edges]):
        for j, (a, b, c) in enumerate(x[triangles]):
            s, u, v = np.linalg.solve(np.stack((p - q, b - a, c - a), axis=1), p - a)
            if 0 < s < 1 and u > 0 and v > 0 and u + v < 1:
                expected.append((i, j))
    assert len(expected) > 5
    assert sorted(map(tuple, crossings(x, edges, triangles).tolist())) == expected


def test_neighbours_of_a_mesh_do_not_cross() -> None:
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.3], [0.2, 0.2, -1], [0.2, 0.2, 1]])
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    sides = np.array([[0, 1], [1, 2], [2, 0], [1, 3], [3, 2]])
    assert not len(crossings(x, sides, triangles))
    assert crossings(x, np.array([[4, 5]]), triangles).tolist() == [[0, 0]]


def test_no_triangles_and_no_edges() -> None:
    nothing = np.empty((0, 2), dtype=np.int64), np.empty((0, 3), dtype=np.int64)
    assert crossings(np.zeros((3, 3)), *nothing).shape == (0, 2)
    assert crossings(np.eye(3), np.array([[0, 1]]), nothing[1]).shape == (0, 2)


def test_a_flat_sheet_that_is_tilted_does_not_cross_itself() -> None:
    # its corners lie in one plane to rounding alone, to whichever side
    rng = np.random.default_rng(0)
    i, j = (k.reshape(-1) for k in np.meshgrid(np.arange(8), np.arange(8), indexing="ij"))
    cells = (i * 9 + j)[:, None]
    triangles = np.concatenate((cells + np.array([0, 9, 10]), cells + np.array([0, 10, 1])))
    sides = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    for _ in range(20):
        axes = rng.normal(size=(2, 3))
        x = (
            rng.normal(size=3)
            + np.array([u * axes[0] + v * axes[1] for u in range(9) for v in range(9)]) / 7.0
        )
        assert not len(crossings(x, sides, triangles))
