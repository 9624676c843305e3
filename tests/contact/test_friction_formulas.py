"""Friction at points of contact: exact tangents, the cone, what is symmetric."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.contact.pieces.cores import BoxCore, LineCore, PointCore
from dismech_cli.contact.points.points import Points, round_points

COUNT = 40


def points_at(core: PointCore | LineCore | BoxCore, p: FloatArray) -> Points:
    """One point of contact each: lines so short that they are points."""
    tiny = np.full_like(p, 1e-9)
    return round_points(core.pieces(p, tiny), np.full(COUNT, 1.0), np.full(COUNT, 3.0))


def test_tangents_against_differences() -> None:
    rng = np.random.default_rng(8)
    for core in (
        PointCore(np.zeros(3)),
        LineCore(np.zeros(3), np.array([0.0, 0.0, 1.0])),
        BoxCore(np.array([0.3, 0.2, 0.1])),
    ):
        p = rng.normal(size=(3, COUNT))
        p *= 0.8 / np.linalg.norm(p, axis=0)
        v = rng.normal(size=(3, COUNT)) * 0.3
        mu = np.full(COUNT, 0.7)

        def force(p: FloatArray, v: FloatArray, core=core, mu=mu) -> FloatArray:
            points = points_at(core, p)
            out = np.zeros((3, COUNT))
            np.add.at(
                out, (slice(None), points.item), points.friction(mu[points.item], 2.0, v[:, points.item])
            )
            return out

        points = points_at(core, p)
        by_position, by_velocity = points.friction_tangents(mu[points.item], 2.0, v[:, points.item])
        dp, dv = rng.normal(size=p.shape), rng.normal(size=v.shape)
        expected_p, expected_v = np.zeros_like(p), np.zeros_like(v)
        # the gap vector of an edge does not follow along the edge
        shape = points.identity * dp[:, points.item] + points.axis * points.e * (
            points.e * dp[:, points.item]
        ).sum(axis=0)
        np.add.at(expected_p, (slice(None), points.item), np.einsum("abk,bk->ak", by_position, shape))
        np.add.at(
            expected_v, (slice(None), points.item), np.einsum("abk,bk->ak", by_velocity, dv[:, points.item])
        )
        h = 1e-6
        along_v = (force(p, v + h * dv) - force(p, v - h * dv)) / (2.0 * h)
        assert_allclose(along_v, expected_v, atol=1e-9 * np.abs(expected_v).max() + 1e-15)
        along_p = (force(p + h * dp, v) - force(p - h * dp, v)) / (2.0 * h)
        assert_allclose(along_p, expected_p, atol=2e-6 * np.abs(expected_p).max() + 1e-15)


def test_within_the_cone_and_against_the_slip() -> None:
    rng = np.random.default_rng(9)
    p = rng.normal(size=(3, COUNT))
    p *= 0.9 / np.linalg.norm(p, axis=0)
    points = points_at(PointCore(np.zeros(3)), p)
    v = 10.0 ** rng.uniform(-9, 3, (1, len(points.item))) * rng.normal(size=(3, len(points.item)))
    force = points.friction(np.full(len(points.item), 0.4), 7.5, v)
    size = np.linalg.norm(force, axis=0)
    assert (size <= 0.4 * points.load * (1.0 + 1e-12)).all()
    assert np.abs((force * points.normal).sum(axis=0)).max() < 1e-12 * size.max()
    slip = v - (v * points.normal).sum(axis=0) * points.normal
    assert ((force * slip).sum(axis=0) >= 0.0).all()
    _, by_velocity = points.friction_tangents(np.full(len(points.item), 0.4), 7.5, v)
    assert_allclose(by_velocity, by_velocity.transpose(1, 0, 2), atol=1e-15)
    assert np.isfinite(points.friction(np.full(len(points.item), 0.4), 7.5, 0.0 * v)).all()
