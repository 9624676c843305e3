"""Nodes that may lie together are found by a sort, and few others with them."""

from __future__ import annotations

import numpy as np

from dismech_cli.mesh.suspects import suspects


def grid():
    return np.stack(np.meshgrid(*3 * [np.linspace(0.0, 1.0, 12)]), axis=-1).reshape(-1, 3)


def test_nodes_of_a_grid_are_above_suspicion():
    assert not len(suspects(grid(), 1e-9))


def test_all_that_lie_together_are_found():
    points = grid()
    rng = np.random.default_rng(3)
    copied = rng.choice(len(points), 40, replace=False)
    away = rng.normal(size=(40, 3))
    away *= 0.9e-9 / np.linalg.norm(away, axis=1, keepdims=True)
    found = suspects(np.concatenate([points, points[copied] + away]), 1e-9)
    assert set(found) == {*copied, *range(len(points), len(points) + 40)}


def test_one_point_is_alone():
    assert not len(suspects(np.zeros((1, 3)), 1e-9))
