"""First directors at rest, against the rule written edge by edge."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from cases import helix, ring, straight, y_network
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.geometry.rotation import orthonormal_to, parallel_transport
from dismech_cli.geometry.vectors import cross
from dismech_cli.kinematics.directors import space_parallel

MANY = 20_000


def by_edge(tangents: FloatArray, given: FloatArray) -> FloatArray:
    """The rule, one edge after the other."""
    out: list[tuple[float, ...]] = []
    columns = [tuple(t) for t in tangents.T.tolist()]
    for i, (t, a) in enumerate(zip(columns, map(tuple, given.T.tolist()), strict=True)):
        if math.isnan(a[0]) and i == 0:
            a = cross(t, (0.0, 1.0, 0.0))
            if math.hypot(*a) < 1e-6:
                a = cross(t, (0.0, 0.0, -1.0))
        elif math.isnan(a[0]):
            a = out[-1]
            if math.hypot(*cross(columns[i - 1], t)) >= 1e-10:
                a = parallel_transport(a, columns[i - 1], t)
        out.append(tuple(map(float, orthonormal_to(a, t))))
    return np.array(out).reshape(-1, 3).T


def unit(x: FloatArray) -> FloatArray:
    return np.asarray(x / np.sqrt((x * x).sum(axis=0)))


def of_edges(shape: tuple[FloatArray, IntArray]) -> FloatArray:
    nodes, edges = shape
    return unit((nodes[edges[:, 1]] - nodes[edges[:, 0]]).T)


def wandering() -> FloatArray:
    """Turns of all sizes, in all directions."""
    return unit(np.random.default_rng(1).normal(size=(3, MANY)))


def zigzag(missing: float) -> Callable[[], FloatArray]:
    """Every edge turns back by pi less an angle, in planes that change."""

    def make() -> FloatArray:
        rng, t = np.random.default_rng(2), np.empty((3, 200))
        t[:, 0] = unit(np.array([0.3, -0.8, 0.5]))
        for i in range(1, t.shape[1]):
            t[:, i] = unit(-t[:, i - 1] + missing * unit(np.cross(t[:, i - 1], rng.normal(size=3))))
        return t

    return make


def folded() -> FloatArray:
    """Edges of a curve of which some run the other way, each twice: exact folds and repetitions."""
    sign = np.random.default_rng(3).choice([-1.0, 1.0], size=2 * 199)
    return np.repeat(of_edges(helix(200)), 2, axis=1) * sign


TANGENTS: dict[str, Callable[[], FloatArray]] = {
    "straight": lambda: of_edges(straight(MANY + 1)),
    "along y": lambda: np.tile([[0.0], [1.0], [0.0]], 50),
    "helix": lambda: of_edges(helix(MANY + 1)),
    "ring": lambda: of_edges(ring(MANY)),
    "branching": lambda: of_edges(y_network()),
    "wandering": wandering,
    "zigzag 1e-3": zigzag(1e-3),
    "zigzag 1e-6": zigzag(1e-6),
    "zigzag 1e-9": zigzag(1e-9),
    "folded": folded,
    "one": lambda: of_edges(straight(2)),
    "none": lambda: np.empty((3, 0)),
}


@pytest.mark.parametrize("name", TANGENTS)
def test_directors_follow_the_rule(name: str) -> None:
    """Without a given director, with one at the start, and with some on the way.

    Either way rounds once or twice an edge, in random directions: 20 000 edges differ by 1e-16 times
    the root of that, some 1e-14.
    """
    tangents = TANGENTS[name]()
    count = tangents.shape[1]
    for restarts in ([], [0], [0, count // 3, count // 2]):
        given = np.full((3, count), np.nan)
        if count:
            given[:, restarts] = np.random.default_rng(4).normal(size=(3, len(restarts)))
        directors = space_parallel(tangents, given)
        assert_allclose((directors * tangents).sum(axis=0), 0.0, atol=1e-15)
        assert_allclose((directors * directors).sum(axis=0), 1.0, rtol=1e-15)
        assert_allclose(directors, by_edge(tangents, given), rtol=0, atol=1e-12)
