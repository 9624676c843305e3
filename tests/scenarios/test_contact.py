"""Scenes of contact against what is known of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dismech_cli
from dismech_cli.arrays import FloatArray, IntArray

FOLDER = Path(__file__).parents[2] / "scenarios"


def test_rod_drop_touches_in_time() -> None:
    report = dismech_cli.simulate(
        FOLDER / "rod_drop.yaml", overrides=["output.every=0.5 ms", "numerics.t_end=0.101 s", "expect={}"]
    )
    first = report.scalars["t"][np.flatnonzero(report.scalars["load"])[0]]
    assert 0.0989 <= first <= 0.1000 + 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(("law", "least"), [("penalty", 0.95), ("barrier", 1.0)])
def test_sheets_lie_on_each_other(law: str, least: float) -> None:
    """Less the tolerance of penetration, of which their weight takes a hundredth; by a barrier never less."""
    changed = [f"contact.law={{type: {law}}}", "expect={}"]
    report = dismech_cli.simulate(FOLDER / "two_sheets.yaml", overrides=changed)
    body = nodes_of(report)
    heights = np.array([frame.positions[:, 2] for frame in report.frames])
    apart = (heights[:, body == 1] - heights[:, body == 0].mean(axis=1, keepdims=True)) / 1e-3
    assert apart.min() >= least
    assert least <= apart[-1].mean() <= 1.05


def nodes_of(report: dismech_cli.Report) -> IntArray:
    """The shell that each node belongs to, shape (N,)."""
    topology = report.composition.simulation.topology
    body = np.zeros(len(topology.rest_positions), dtype=np.int64)
    body[topology.triangles] = topology.triangle_body[:, None]
    return body


@pytest.mark.slow
def test_folded_cloth_stays_symmetric_and_keeps_its_area() -> None:
    report = dismech_cli.simulate(FOLDER / "folded_cloth.yaml", overrides=["expect={}"])
    topology = report.composition.simulation.topology
    mirrored = mirror_images(topology.rest_positions)
    assert np.array_equal(mirrored[mirrored], np.arange(len(mirrored)))
    whole = area(topology.rest_positions, topology.triangles)
    for frame in report.frames:
        x = frame.positions
        assert np.abs(x[mirrored] * [1.0, -1.0, 1.0] - x).max() < 1e-6 * 0.2
        assert abs(area(x, topology.triangles) / whole - 1.0) < 0.01


def area(x: FloatArray, triangles: IntArray) -> float:
    """Of all triangles [m^2]."""
    a, b, c = x[triangles].transpose(1, 0, 2)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


@pytest.mark.slow
def test_spider_lands_in_time_and_stays_symmetric() -> None:
    report = dismech_cli.simulate(
        FOLDER / "spider.yaml", overrides=["output.every=2.5 ms", "numerics.t_end=0.3 s", "expect={}"]
    )
    assert report.exit == 0
    load = report.scalars["front"]
    first = report.scalars["t"][np.flatnonzero(load)[0]]
    # the feet fall 95 mm; the first step that ends inside is at most one step of 2.5 ms late
    assert 0.0 <= first - np.sqrt(2 * 0.095 / 9.8) <= 2.5e-3
    mirrored = mirror_images(report.frames[0].positions)
    last = report.frames[-1].positions
    assert np.abs(last[mirrored] * [1.0, -1.0, 1.0] - last).max() < 1e-7


def mirror_images(positions: FloatArray) -> IntArray:
    """The node that is the image of each in the plane y = 0."""
    images = positions * [1.0, -1.0, 1.0]
    return np.linalg.norm(images[:, None] - positions, axis=2).argmin(axis=1)


def test_worm_stays_where_it_is_without_friction() -> None:
    report = dismech_cli.simulate(
        FOLDER / "worm.yaml",
        overrides=["contact.friction.coefficient=0", "numerics.t_end=1.5 s", "expect={}"],
    )
    assert report.exit == 0
    # contraction moves material, but nothing moves the middle of the mass
    frames = report.frames
    weights = np.ones(41)
    weights[[0, -1]] = 0.5
    middles = [np.average(frame.positions[:, 0], weights=weights) for frame in frames]
    assert np.ptp(middles) < 1e-9
    assert np.abs(frames[-1].positions[:, 0] - frames[0].positions[:, 0]).max() < 1e-4
