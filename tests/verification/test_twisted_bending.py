"""Twist and bending do not disturb each other, however far the joints of a rod are twisted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, scalar, solve, tip
from numpy.testing import assert_allclose
from scipy.linalg import expm

from dismech_cli.arrays import FloatArray
from dismech_cli.kinematics.strains import curvature_binormal


def cantilever(nodes: int, twist: float) -> Deck:
    """Round, naturally twisted, P L^2/(EI) = 1."""
    return rod_deck(
        line(nodes),
        dimension=3,
        rod={"natural": {"twist": twist}},
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, -1.0]}],
    )


@pytest.mark.parametrize("twist", [30.0, 60.0, 120.0])
def test_a_round_cantilever_bends_alike_at_any_natural_twist(tmp_path: Path, twist: float) -> None:
    """Up to 4.8 rad per joint; the mesh alone decides how far the tip is from the elastica."""
    plain, twisted = (tip(solve(tmp_path, cantilever(26, t))) for t in (0.0, twist))
    assert_allclose(twisted, plain, rtol=0.0, atol=1e-10)
    # exact 0.30172077; second order in the edge
    assert_allclose(plain[2], -0.30172077, rtol=1e-3)


def grown(folder: Path, nodes: int, curvature: float, twist: float) -> tuple[FloatArray, float]:
    """Nodes [m] and elastic energy [J] of a straight rod that has grown into a helix."""
    deck = rod_deck(
        line(nodes),
        given_section(torsion=0.7),
        dimension=3,
        numerics={"integrator": {"type": "static", "load_steps": 100}},
        actuation=[
            {"type": name, "rod": "rod", "value": {"table": [[0.0, 0.0], [1.0, value]]}}
            for name, value in (("curvature_1", curvature), ("twist", twist))
        ],
        output={"probes": {"stored": {"energy": "elastic"}}},
    )
    result = solve(folder, deck)
    return result.frames[-1].positions, float(scalar(result, "stored")[-1])


def grown_tip(curvature: float, twist: float) -> FloatArray:
    """t' = k1 m1, m1' = -k1 t + tau m2, m2' = -tau m1 over unit length, from t = x, m1 = z, m2 = -y."""
    darboux = np.array([[0.0, curvature, 0.0], [-curvature, 0.0, twist], [0.0, -twist, 0.0]])
    whole = np.block([[np.zeros((1, 1)), np.eye(1, 3)], [np.zeros((3, 1)), darboux]])
    place = expm(whole)[0, 1:]
    return np.array([place[0], -place[2], place[1]])


@pytest.mark.parametrize(("curvature", "twist"), [(20.0, 40.0), (5.0, 100.0)])
def test_curvature_and_twist_grow_together_into_a_helix(
    tmp_path: Path, curvature: float, twist: float
) -> None:
    exact = grown_tip(curvature, twist)
    errors = []
    for nodes in (51, 101):
        positions, stored = grown(tmp_path, nodes, curvature, twist)
        triples = np.arange(nodes - 2)[:, None] + np.arange(3)
        bend = np.linalg.norm(curvature_binormal(positions, triples), axis=1)
        # all that the joints are asked for, twisted by 0.4 to 2 rad each as they are
        assert_allclose(bend, curvature / (nodes - 1), rtol=1e-9)
        assert stored < 1e-14
        errors.append(float(np.linalg.norm(positions[-1] - exact)))
    assert errors[0] < 1.5e-2
    assert np.log2(errors[0] / errors[1]) > 1.9


def test_reported_moment_of_a_grown_rod_is_zero(tmp_path: Path) -> None:
    deck = rod_deck(
        line(21),
        given_section(bending_2=2.5),
        dimension=3,
        numerics={"integrator": {"type": "static", "load_steps": 20}},
        actuation=[
            {"type": name, "rod": "rod", "value": {"table": [[0.0, 0.0], [1.0, value]]}}
            for name, value in (("curvature_1", 3.0), ("curvature_2", 2.0), ("twist", 20.0))
        ],
        output={"fields": ["bending_moment", "curvature", "twist"]},
    )
    fields = solve(tmp_path, deck).frames[-1].fields
    assert_allclose(fields["bending_moment"], 0.0, atol=1e-8)
    assert_allclose(fields["curvature"][1:-1], np.hypot(3.0, 2.0), rtol=1e-8)
    assert_allclose(fields["twist"][1:-1], 20.0, rtol=1e-8)
