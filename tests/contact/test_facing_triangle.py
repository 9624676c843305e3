"""Lines against triangles: pieces by the feature that they face, and the energy summed along them."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from dismech_cli.arrays import BoolArray, FloatArray
from dismech_cli.contact.pieces.cores import beside
from dismech_cli.contact.pieces.facing_triangle import facing
from dismech_cli.contact.pieces.pieces import spots
from dismech_cli.contact.points.points import Points, round_points

COUNT = 1000
REACH = 0.8


def random_pairs(seed: int) -> FloatArray:
    """Nodes of lines and triangles, shape (5, 3, COUNT)."""
    return np.random.default_rng(seed).normal(size=(5, 3, COUNT))


def points(q: FloatArray) -> Points:
    count = q.shape[-1]
    return round_points(facing(q[0], q[1] - q[0], q[2:]), np.full(count, REACH), np.ones(count))


def energies(q: FloatArray) -> FloatArray:
    found = points(q)
    return np.bincount(found.item, weights=found.energy, minlength=q.shape[-1])


def gradients(q: FloatArray) -> FloatArray:
    found = points(q)
    out = np.zeros((q.shape[-1], 5, 3))
    np.add.at(out, found.item, found.gradients().transpose(2, 0, 1))
    return out.transpose(1, 2, 0)


def distance(x: FloatArray, corners: FloatArray) -> FloatArray:
    """Of points from triangles, from the projection and the three sides."""
    far = []
    inside: BoolArray = np.ones(x.shape[1], dtype=np.bool_)
    n = np.cross(corners[1] - corners[0], corners[2] - corners[0], axis=0)
    for p, q in ((0, 1), (1, 2), (2, 0)):
        u, r = corners[q] - corners[p], x - corners[p]
        gap = r - np.clip((r * u).sum(axis=0) / (u * u).sum(axis=0), 0.0, 1.0) * u
        far.append(np.sqrt((gap * gap).sum(axis=0)))
        inside &= (np.cross(n, u, axis=0) * r).sum(axis=0) >= 0.0
    height = np.abs((n * (x - corners[0])).sum(axis=0)) / np.sqrt((n * n).sum(axis=0))
    return np.where(inside, height, np.min(far, axis=0))


def test_pieces_cover_the_line_and_gaps_are_distances() -> None:
    q = random_pairs(0)
    pieces = facing(q[0], q[1] - q[0], q[2:])
    covered = np.bincount(pieces.item, weights=pieces.high - pieces.low)
    assert_allclose(covered, 1.0, rtol=1e-14)
    at = spots(pieces.low, pieces.high)
    near = pieces.some(at.piece)
    gap = near.start + at.s * near.slope
    x = q[0][:, near.item] + at.s * (q[1] - q[0])[:, near.item]
    corners = q[2:, :, near.item]
    assert_allclose(np.sqrt((gap * gap).sum(axis=0)), distance(x, corners), atol=1e-13)
    weights = near.along[0] + at.s * near.along[1]
    assert_allclose(weights.sum(axis=0), 1.0, rtol=1e-12)
    assert_allclose(x - (weights[:, None] * corners).sum(axis=0), gap, atol=1e-11)


def test_derivatives_against_differences() -> None:
    q, h = random_pairs(1), 1e-6
    found = points(q)
    hessian = np.zeros((COUNT, 5, 5, 3, 3))
    np.add.at(hessian, found.item, found.hessians().transpose(4, 0, 1, 2, 3))
    gradient = gradients(q)
    assert np.abs(hessian).max() > 0.5
    for node in range(5):
        for axis in range(3):
            ahead, back = q.copy(), q.copy()
            ahead[node, axis] += h
            back[node, axis] -= h
            slope = (energies(ahead) - energies(back)) / (2.0 * h)
            curve = (gradients(ahead) - gradients(back)) / (2.0 * h)
            assert_allclose(gradient[node, axis], slope, atol=1e-8)
            # at the rim of the reach the second derivative jumps: there differences are of first order
            assert_allclose(hessian[:, :, node, :, axis].transpose(1, 2, 0), curve, atol=1e-6)


def test_no_net_force_and_no_net_moment() -> None:
    q = random_pairs(2)
    force = gradients(q)
    size = np.abs(force).sum()
    assert size > 1.0
    assert np.abs(force.sum(axis=0)).max() < 1e-13
    assert np.abs(np.cross(q, force, axis=1).sum(axis=0)).max() < 1e-12


def test_a_line_cut_in_two_keeps_the_energy() -> None:
    q = random_pairs(3)
    middle = q[0] + 0.37 * (q[1] - q[0])
    one, other = q.copy(), q.copy()
    one[1], other[0] = middle, middle
    assert_allclose(0.37 * energies(one) + 0.63 * energies(other), energies(q), rtol=1e-11, atol=1e-13)


def test_a_triangle_cut_in_two_less_the_cut_keeps_the_energy() -> None:
    q = random_pairs(4)
    cut = q[2] + 0.41 * (q[3] - q[2])
    one, other = q.copy(), q.copy()
    one[3], other[2] = cut, cut
    edge = round_points(beside(q[0], q[1] - q[0], cut, q[4]), np.full(COUNT, REACH), np.ones(COUNT))
    double = np.bincount(edge.item, weights=edge.energy, minlength=COUNT)
    assert_allclose(energies(one) + energies(other) - double, energies(q), rtol=1e-11, atol=1e-12)
