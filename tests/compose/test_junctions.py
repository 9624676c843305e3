"""Rods welded in space: the answer does not depend on how directors were chosen along the limbs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import dismech_cli

DECK = """
schema_version: 1
name: tripod
materials: {{m: {{youngs_modulus: 1 MPa, poisson_ratio: 0.5, density: 1000}}}}
geometry:
  - {{type: rod, name: mast, material: m, radius: 2 mm, bending: framed, director: {mast},
     generate: {{shape: line, from: [0, 0, 0], to: [0, 0, 0.1], nodes: 9}}}}
  - {{type: rod, name: arm, material: m, radius: 2 mm, director: {arm},
     generate: {{shape: line, from: [0, 0, 0.1], to: [0.06, 0.05, 0.1], nodes: 9}}}}
  - {{type: rod, name: leg, material: m, radius: 2 mm, director: {leg},
     generate: {{shape: line, from: [0.06, 0.05, 0.1], to: [0.09, 0.02, 0.06], nodes: 9}}}}
joints:
  - {{type: rigid, nodes: [mast.end, arm.start]}}
  - {{type: rigid, nodes: [arm.end, leg.start]}}
motions: [{{type: clamp, where: mast.start}}]
forces: [{{type: point, where: leg.end, force: [0.004, 0.002, -0.006]}}]
numerics: {{integrator: {{type: static, load_steps: 4}}, newton: {{tolerance: 1.0e-11}}}}
"""


def shape(folder: Path, mast: str, arm: str, leg: str) -> np.ndarray:  # type: ignore[type-arg]
    deck = folder / "tripod.yaml"
    deck.write_text(DECK.format(mast=mast, arm=arm, leg=leg))
    result = dismech_cli.simulate(deck)
    assert result.outcome.end.name == "DONE", result.outcome.message
    return result.frames[-1].positions


@pytest.mark.parametrize("arm", ["[0, 0, 1]", "[1, -1, 1]", "[-0.5, 0.6, -0.3]"])
def test_bending_of_a_space_frame_is_independent_of_directors(tmp_path: Path, arm: str) -> None:
    """Round sections have no preferred direction; the frames are arbitrary, so the shape is not.

    Solutions agree to the Newton tolerance times the compliance (1e-11 * 0.1 m and a margin for the
    time-parallel gradient within a load step, which depends on the frames at 1e-9).
    """
    reference = shape(tmp_path, "[1, 0, 0]", "[0, 0, 1]", "[0, 1, 0]")
    turned = shape(tmp_path, "[0.3, 1, 0]", arm, "[1, 0.2, 0.4]")
    assert np.abs(reference[-1] - [0.09, 0.02, 0.06]).max() > 5e-3, "the load must bend it"
    assert_allclose(turned, reference, atol=1e-8)
