"""Fields over time and space, and the exact slopes of expressions."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from order import observed_order

from dismech_cli.errors import LawError
from dismech_cli.laws.expression import FUNCTIONS, ExpressionError
from dismech_cli.laws.field import Spatial, Uniform
from dismech_cli.laws.laws import Ramp

X = np.random.default_rng(3).uniform(0.2, 0.9, (7, 3))
T = 0.7
TEXTS = {
    "sin": "sin(x*y) - z",
    "cos": "cos(2*x + t)/y",
    "tan": "tan(x*z)",
    "tanh": "tanh(3*x - y)",
    "exp": "exp(-x*y*z)",
    "log": "log(x + 2*y)",
    "sqrt": "sqrt(x**2 + y**2)",
    "abs": "abs(x - 2*y) + abs(z - 2)",
    "floor": "floor(5*x) + y**2",
    "min": "min(x*x, y, z + 0.05)",
    "max": "max(x*x, y, z*z, 0.31)",
    "clip": "clip(3*x - y, 0.4, z)*y",
    "sawtooth": "sawtooth(9*x + y) + sawtooth(5*z, 0.3) + sawtooth(4*x, 0)",
    "square": "square(3*x)*y",
    "step": "step(x - 0.5)*z",
    "smoothstep": "smoothstep(2*x - 0.5)*smoothstep(y)",
    "powers": "x**16 + y**-2 + (x*z)**0.5 + z**1 + (1 + x)**-16",
    "signs": "-x*(-y)/(+z) - 3",
}


def test_every_function_has_a_slope() -> None:
    assert set(FUNCTIONS) <= set(TEXTS)


@pytest.mark.parametrize("name", TEXTS)
def test_slopes_against_differences(name: str) -> None:
    """Central differences converge to the slope at second order, or agree to rounding."""
    field = Spatial(TEXTS[name])
    slope = field.gradient(T, X)
    steps = 2.0 ** -np.arange(11.0, 15.0)
    errors = []
    for h in steps:
        difference = np.stack(
            [(field.value(T, X + e) - field.value(T, X - e)) / (2.0 * h) for e in h * np.eye(3)], axis=1
        )
        errors.append(float(np.abs(difference - slope).max()))
    assert np.abs(slope).max() > 1e-3
    if errors[0] > 1e-10:
        assert observed_order(steps, np.array(errors)) > 1.9


def test_where_a_field_has_no_value() -> None:
    with pytest.raises(LawError, match=r"'log\(z\)' has no finite value or slope at t = 0.7 s and \(0"):
        Spatial("log(z)").value(T, np.zeros((2, 3)))
    with pytest.raises(LawError, match="slope"):
        Spatial("sqrt(x)").gradient(T, np.zeros((2, 3)))
    with pytest.raises(ExpressionError, match="width of a sawtooth depends on x"):
        Spatial("sawtooth(t, x)")


def test_uniform_fields() -> None:
    field = Uniform(Ramp(before=0.0, after=2.0, start=0.0, end=1.0))
    assert_array_equal(field.value(0.5, X), np.ones(7))
    assert_array_equal(field.gradient(0.5, X), np.zeros((7, 3)))
    assert Spatial("sin(t)").uniform
    assert not Spatial("sin(t)*x").uniform


def test_pickles() -> None:
    field = Spatial("x*sin(t)")
    assert_allclose(pickle.loads(pickle.dumps(field)).gradient(T, X), field.gradient(T, X), rtol=0)
