"""A count of negative eigenvalues that has no value does not end the run."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import dismech_cli
from dismech_cli.session.exit_codes import Exit

# Nothing resists across a straight edge without tension: the stiffness has a row of zeros.
LOOSE = """
schema_version: 1
name: loose
dimension: 2
materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.5, density: 1000}}
geometry:
  - {type: rod, name: bar, material: m, radius: 2 mm,
     generate: {shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 2}}
motions: [{type: pin, where: bar.start}]
numerics: {integrator: {type: static, load_steps: 3}}
output: {probes: {unstable: {negative_eigenvalues: true}}}
"""


def test_it_is_nan_with_one_warning_that_says_where_and_when(tmp_path: Path) -> None:
    deck = tmp_path / "loose.yaml"
    deck.write_text(LOOSE)
    report = dismech_cli.simulate(deck)
    assert report.exit is Exit.DONE
    assert np.isnan(report.probes["unstable"]).all()
    assert len(report.probes["unstable"]) == 4
    (warning,) = (text for text in report.warnings if "negative_eigenvalues" in text)
    assert "at t = 0: the matrix is singular" in warning
    assert "z of node 1 (rod 'bar', node 1 of 2)" in warning
