"""Scenes of contact seen by an oracle that shares no code with the search: distances of sampled points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dismech_cli
from dismech_cli.arrays import FloatArray

FOLDER = Path(__file__).parents[2] / "scenarios"
SAMPLES = np.linspace(0.0, 1.0, 9)


def least_distances(report: dismech_cli.Report) -> FloatArray:
    """Least distance of sampled points of edges that are no neighbours, over the sum of radii, per frame."""
    topology = report.composition.simulation.topology
    edges, radius, body = topology.edges, topology.edge_radius, topology.edge_body
    length = np.linalg.norm(np.diff(topology.rest_positions[edges], axis=1)[:, 0], axis=1).min()
    i, j = np.triu_indices(len(edges), k=1)
    far = (body[i] != body[j]) | ((j - i - 1) * length > np.pi * radius.max())
    i, j = i[far], j[far]
    found = []
    for frame in report.frames:
        ends = frame.positions[edges]
        p = ends[:, :1] + SAMPLES[:, None] * (ends[:, 1:] - ends[:, :1])
        middle = ends.mean(axis=1)
        reach = radius[i] + radius[j] + np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).max()
        near = np.flatnonzero(np.linalg.norm(middle[i] - middle[j], axis=1) < reach)
        if not len(near):
            found.append(np.inf)
            continue
        a, b = i[near], j[near]
        apart = np.linalg.norm(p[a][:, :, None] - p[b][:, None], axis=3).min(axis=(1, 2))
        found.append(float((apart / (radius[a] + radius[b])).min()))
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "tolerance"), [("crossed_rods", 0.05), ("overhand_knot", 0.1), ("entanglement_gripper", 0.05)]
)
def test_nothing_is_deeper_than_the_tolerance(name: str, tolerance: float) -> None:
    report = dismech_cli.simulate(FOLDER / f"{name}.yaml")
    assert report.exit == 0
    least = least_distances(report)
    assert least.min() < 1.02
    # the samples are no nearer than the lines, and off by their spacing squared
    assert least.min() >= 1.0 - tolerance - 1e-9
