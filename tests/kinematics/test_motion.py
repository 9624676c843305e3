"""Which held DOFs move, and between which times nothing is let go."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.kinematics.motion import Motion, held_span, moving_dofs
from dismech_cli.laws.laws import Constant, Law, Ramp

REST = np.array([0.0, 0.1, 0.2, 0.3])
RAMP = Ramp(before=0.0, after=1.0, start=0.5, end=1.0)


def _motion(law: Law, release: float = inf) -> Motion:
    dofs = np.array([1, 3])
    return Motion("m", dofs, REST[dofs], law, release)


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (_motion(Constant(0.0)), []),
        (_motion(Constant(1e-9)), [1, 3]),
        (_motion(RAMP), [1, 3]),
        (_motion(RAMP, release=2.0), [1, 3]),
        (_motion(RAMP, release=1.0), []),
    ],
    ids=["stays", "jumps", "moves later", "held on", "let go"],
)
def test_held_dofs_that_move(motion: Motion, expected: list[int]) -> None:
    assert_array_equal(moving_dofs([motion], REST, np.zeros(4), 1.0), expected)


def test_a_hold_that_stops_a_dof_moves_it() -> None:
    velocity = np.array([5.0, 0.0, 5.0, 5.0])
    assert_array_equal(moving_dofs([_motion(Constant(0.0))], REST, velocity, 0.0), [3])


@pytest.mark.parametrize(
    ("t", "span"), [(0.0, (-inf, 1.0)), (1.0, (1.0, 3.0)), (2.9, (1.0, 3.0)), (3.0, (3.0, inf))]
)
def test_span_between_releases(t: float, span: tuple[float, float]) -> None:
    motions = [_motion(RAMP, release) for release in (3.0, 1.0, inf)]
    assert held_span(motions, t) == span
