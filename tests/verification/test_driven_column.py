"""A pinned column whose end is pushed in far beyond Euler's load, against elliptic integrals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks import Deck, given_section, line, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

LENGTH, PUSHED = 2.0, 1.4


def column(load_steps: int) -> Deck:
    """Stiff along its axis; a small force aside breaks the symmetry while the first fifth is pushed in."""
    return rod_deck(
        line(121, (LENGTH, 0.0, 0.0)),
        given_section(axial=1e8),
        motions=[
            {"type": "pin", "where": "rod.start"},
            {
                "type": "pin",
                "where": "rod.end",
                "displacement": [{"table": [[0.0, 0.0], [1.0, -PUSHED]]}, 0.0, 0.0],
            },
        ],
        forces=[
            {
                "type": "point",
                "where": {"nearest": [1.0, 0.0, 0.0]},
                "force": [0.0, 0.0, {"table": [[0.0, 0.1], [0.1, 0.1], [0.2, 0.0]]}],
            }
        ],
        numerics={"integrator": {"type": "static", "load_steps": load_steps}},
        output={
            "probes": {
                "push": {"reaction": "rod.end", "component": "x"},
                "aside": {"displacement": {"nearest": [1.0, 0.0, 0.0]}, "component": "z"},
                "negative": {"negative_eigenvalues": True},
            }
        },
    )


@pytest.mark.parametrize("load_steps", [20, 5])
def test_it_buckles_into_the_elastica(tmp_path: Path, load_steps: int) -> None:
    """Shortening 2 (1 - E/K) L, load 4 K^2 EI/L^2, sag sqrt(m) L/K; m = sin^2(end slope/2)."""
    m = brentq(lambda m: 2.0 * (1.0 - ellipe(m) / ellipk(m)) * LENGTH - PUSHED, 1e-6, 0.99)
    result = solve(tmp_path, column(load_steps))
    assert scalar(result, "negative")[-1] == 0
    # second order in the edge: (1/120)^2 times a number of order one
    assert_allclose(scalar(result, "push")[-1], -4.0 * ellipk(m) ** 2 / LENGTH**2, rtol=2e-3)
    assert_allclose(np.abs(scalar(result, "aside")[-1]), np.sqrt(m) * LENGTH / ellipk(m), rtol=2e-3)
    if load_steps == 20:
        # the way of longer load steps goes by rounding, and so by the processor
        assert result.outcome.counters["iterations"] < 300
