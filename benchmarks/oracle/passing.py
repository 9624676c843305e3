"""Whether anything passed through anything on the straight ways between frames.

By roots of cubics: the volume of four points that move evenly is one in time, and what passes does so where
it vanishes. Nothing here is shared with what finds contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from scipy.spatial import cKDTree

from dismech_cli import Report
from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.output.frame import Frame

from .rigid import Rigid

_Meet: TypeAlias = Callable[[FloatArray], bool]

_TIMES: Final = np.linspace(0.0, 1.0, 4)
_POWERS: Final = np.linalg.inv(np.vander(_TIMES, increasing=True))
# from powers of t to Bernstein's polynomials of degree three
_BERNSTEIN: Final = np.array([[1, 0, 0, 0], [1, 1 / 3, 0, 0], [1, 2 / 3, 1 / 3, 0], [1, 1, 1, 1]])
# Volumes below this share of lengths cubed are rounding.
_ROUNDING: Final = 1e-13
_EDGE: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Features:
    """What may pass: edges through edges, nodes through triangles.

    Attributes:
        edges: Ends of all edges of rods and shells, shape (E, 2).
        triangles: Corners, shape (T, 3).
        rest: Rest positions [m], shape (N, 3).
    """

    edges: IntArray
    triangles: IntArray
    rest: FloatArray


def features(report: Report, rigid: Rigid) -> Features:
    """Those of a run; what obstacles are made of has the nodes after those of bodies."""
    topology = report.composition.simulation.topology
    obstacles = rigid.triangles + len(topology.rest_positions)
    triangles = np.concatenate((topology.triangles, obstacles))
    sides = np.concatenate([topology.edges, *(triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0]))])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    rest = np.concatenate((topology.rest_positions, rigid.vertices(0.0)))
    return Features(edges=edges, triangles=triangles, rest=rest)


def passed(report: Report) -> list[tuple[float, list[int]]]:
    """Time [s] and the four nodes of everything that passed through something, between any two frames."""
    rigid = Rigid.of(report)
    what, frames = features(report, rigid), report.frames
    flat = np.ptp(np.concatenate([frame.positions for frame in frames]), axis=0) == 0.0
    found: list[tuple[float, list[int]]] = []
    before = _places(frames[0], rigid)
    for frame in frames[1:]:
        now = _places(frame, rigid)
        four = crossing(what, now[:, ~flat]) if flat.any() else passing(what, before, now)
        found += [(float(frame.t), nodes) for nodes in four.tolist()]
        before = now
    return found


def _places(frame: Frame, rigid: Rigid) -> FloatArray:
    return np.concatenate((frame.positions, rigid.vertices(frame.t)))


def passing(what: Features, x0: FloatArray, x1: FloatArray) -> IntArray:
    """Four nodes of each pair that passed on the straight way from ``x0`` to ``x1`` (N, 3), shape (P, 4)."""
    found = [np.empty((0, 4), dtype=np.int64)]
    spots = np.concatenate((x0, x1), axis=1).reshape(len(x0), 2, 3)
    edges = _boxes(spots, what.edges)
    for i, j in _chunks(near(edges, edges)):
        one = i < j
        four = np.concatenate((what.edges[i[one]], what.edges[j[one]]), axis=1)
        found.append(_through(what, four, x0, x1, _edges_meet))
    if len(what.triangles):
        nodes = np.unique(what.edges.reshape(-1))
        for i, j in _chunks(near(_boxes(spots, nodes[:, None]), _boxes(spots, what.triangles))):
            four = np.concatenate((nodes[i][:, None], what.triangles[j]), axis=1)
            found.append(_through(what, four, x0, x1, _inside))
    return np.concatenate(found)


def _boxes(spots: FloatArray, nodes: IntArray) -> tuple[FloatArray, FloatArray]:
    places = spots[nodes].reshape(len(nodes), -1, 3)
    return places.min(axis=1), places.max(axis=1)


def near(one: tuple[FloatArray, FloatArray], two: tuple[FloatArray, FloatArray]) -> IntArray:
    """Pairs of boxes that overlap, shape (2, P)."""
    sizes = [float(np.linalg.norm(high - low, axis=1).max()) / 2 for low, high in (one, two)]
    trees = [cKDTree((low + high) / 2) for low, high in (one, two)]
    near = trees[0].sparse_distance_matrix(trees[1], sum(sizes), output_type="coo_matrix")
    i, j = near.row.astype(np.int64), near.col.astype(np.int64)
    some = ((one[0][i] <= two[1][j]) & (two[0][j] <= one[1][i])).all(axis=1)
    return np.stack((i[some], j[some]))


def _chunks(pairs: IntArray) -> list[tuple[IntArray, IntArray]]:
    parts = np.array_split(pairs, pairs.shape[1] // 300_000 + 1, axis=1)
    return [(part[0], part[1]) for part in parts]


def _through(what: Features, four: IntArray, x0: FloatArray, x1: FloatArray, meet: _Meet) -> IntArray:
    """Those of some four nodes each (P, 4) that pass; what shares a node or a place at rest never does."""
    ordered = np.sort(four, axis=1)
    four = four[(np.diff(ordered, axis=1) > 0).all(axis=1)]
    rest = what.rest[four]
    scale = np.ptp(rest, axis=1).max(axis=1)
    apart = np.linalg.norm(rest[:, :, None] - rest[:, None], axis=3) + np.eye(4) * scale[:, None, None]
    four = four[apart.min(axis=(1, 2)) > 1e-9 * scale]
    way0, way1 = x0[four], x1[four]
    values = np.stack([_volume(way0 + t * (way1 - way0)) for t in _TIMES], axis=1)
    powers = values @ _POWERS.T
    bounds = powers @ _BERNSTEIN.T
    size = np.ptp(np.concatenate((way0, way1), axis=1), axis=1).max(axis=1) ** 3
    mixed = (bounds.min(axis=1) < -_ROUNDING * size) & (bounds.max(axis=1) > _ROUNDING * size)
    kept = [k for k in np.flatnonzero(mixed) if _meets(powers[k], way0[k], way1[k], meet)]
    return four[kept]


def _meets(powers: FloatArray, start: FloatArray, end: FloatArray, meet: _Meet) -> bool:
    """Whether two things meet at a root of their volume within the way."""
    roots = np.roots(powers[::-1])
    times = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real >= 0.0) & (roots.real <= 1.0)]
    return any(meet(start + t * (end - start)) for t in times)


def _volume(x: FloatArray) -> FloatArray:
    """Of four points each, shape (P, 4, 3)."""
    a, b, c, d = x.transpose(1, 0, 2)
    return np.asarray(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a))


def _edges_meet(x: FloatArray) -> bool:
    """Whether two edges in one plane cross."""
    a, b, c, d = x
    s, u = np.linalg.lstsq(np.stack((b - a, c - d), axis=1), c - a, rcond=None)[0]
    apart = a + s * (b - a) - c - u * (d - c)
    near = np.linalg.norm(apart) < 1e-6 * np.linalg.norm(b - a)
    return bool(near and min(s, u) > -_EDGE and max(s, u) < 1.0 + _EDGE)


def _inside(x: FloatArray) -> bool:
    """Whether the first of four points in one plane lies between the others."""
    p, a, b, c = x
    u, v = np.linalg.lstsq(np.stack((b - a, c - a), axis=1), p - a, rcond=None)[0]
    return bool(min(u, v) > -_EDGE and u + v < 1.0 + _EDGE)


def crossing(what: Features, x: FloatArray) -> IntArray:
    """Nodes of edges of a plane scene that cross, shape (P, 4), from places in the plane (N, 2)."""
    i, j = np.triu_indices(len(what.edges), k=1)
    four = np.concatenate((what.edges[i], what.edges[j]), axis=1)
    four = four[(four[:, :2, None] != four[:, None, 2:]).all(axis=(1, 2))]
    a, b, c, d = x[four].transpose(1, 0, 2)
    through = (_turn(a, b, c) * _turn(a, b, d) < 0.0) & (_turn(c, d, a) * _turn(c, d, b) < 0.0)
    return np.asarray(four[through])


def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    u, v = b - a, c - a
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
