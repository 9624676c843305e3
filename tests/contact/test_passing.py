"""The oracle that looks for what passed through something."""

from __future__ import annotations

import numpy as np

from benchmarks.oracle.passing import Features, crossing, passing

NO_TRIANGLES = np.empty((0, 3), dtype=np.int64)


def test_random_edges_pass_as_many_small_steps_say() -> None:
    rng = np.random.default_rng(1)
    found, expected = 0, 0
    what = Features(edges=np.array([[0, 1], [2, 3]]), triangles=NO_TRIANGLES, rest=np.eye(4)[:, :3])
    for _ in range(300):
        x0, x1 = rng.normal(size=(2, 4, 3))
        t = np.linspace(0.0, 1.0, 4001)[:, None, None]
        a, b, c, d = (x0 + t * (x1 - x0)).transpose(1, 0, 2)
        volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
        there = False
        for k in np.flatnonzero(volume[:-1] * volume[1:] < 0.0):
            s, u = np.linalg.lstsq(np.stack((b[k] - a[k], c[k] - d[k]), axis=1), c[k] - a[k], rcond=None)[0]
            there |= bool(0.0 < s < 1.0 and 0.0 < u < 1.0)
        passes = len(passing(what, x0, x1)) > 0
        assert passes == there
        found, expected = found + passes, expected + there
    assert found == expected > 20


def test_a_node_passes_through_a_triangle() -> None:
    x0 = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 0.5], [0.2, 0.2, 1.5]])
    what = Features(
        edges=np.array([[0, 1], [1, 2], [0, 2], [3, 4]]), triangles=np.array([[0, 1, 2]]), rest=x0
    )
    down = x0 - np.outer([0, 0, 0, 1, 1], [0.0, 0.0, 1.0])
    assert passing(what, x0, down).tolist() == [[3, 0, 1, 2]]
    assert not len(passing(what, x0, x0 - np.outer([0, 0, 0, 1, 1], [0.0, 0.0, 0.4])))
    beside = x0 + np.outer([0, 0, 0, 1, 1], [1.0, 1.0, 0.0])
    assert not len(passing(what, beside, beside - np.outer([0, 0, 0, 1, 1], [0.0, 0.0, 1.0])))


def test_edges_in_a_plane_cross() -> None:
    x = np.array([[0.0, 0], [1, 0], [0.5, -1], [0.5, 1], [2, 1]])
    what = Features(edges=np.array([[0, 1], [2, 3], [3, 4]]), triangles=NO_TRIANGLES, rest=np.eye(5)[:, :3])
    assert crossing(what, x).tolist() == [[0, 1, 2, 3]]
    x[3] = [0.5, -0.5]
    x[4] = [2, -1]
    assert not len(crossing(what, x))
