"""Time laws and the arithmetic language."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.errors import LawError, ScenarioError
from dismech_cli.laws.expression import ExpressionError, compile_expression
from dismech_cli.laws.laws import Constant, Expression, Law, Ramp, Sawtooth, Sine, Table

ROUNDING = 1e-15

LAWS: list[Law] = [
    Constant(2.0),
    Table(times=(0.0, 1.0, 3.0), values=(0.0, 2.0, 1.0)),
    Table(times=(0.0, 1.0, 3.0), values=(0.0, 2.0, 1.0), interpolation="step"),
    Table(times=(0.0, 1.0, 3.0), values=(0.0, 2.0, 1.0), interpolation="cubic"),
    Ramp(before=1.0, after=3.0, start=1.0, end=2.0),
    Sine(amplitude=2.0, frequency=0.25, offset=1.0),
    Sawtooth(amplitude=1.0, frequency=1.0),
    Expression("2*t"),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: repr(law)[:40])
def test_shape_follows_s_and_pickles(law: Law) -> None:
    s = np.linspace(0.0, 1.0, 4)
    value, values = law(0.7), law(0.7, s)
    assert isinstance(value, float)
    assert_array_equal(values, np.full(4, value))
    assert pickle.loads(pickle.dumps(law))(0.7) == value


def test_table_is_held_outside_and_linear_between() -> None:
    law = LAWS[1]
    assert_allclose([law(t) for t in (-1.0, 0.5, 2.0, 9.0)], [0.0, 1.0, 1.5, 1.0], rtol=ROUNDING)


def test_step_table_jumps_at_its_times() -> None:
    assert [LAWS[2](t) for t in (-1.0, 0.0, 0.999, 1.0, 2.999, 3.0)] == [0.0, 0.0, 0.0, 2.0, 2.0, 1.0]


def test_cubic_table_is_the_natural_spline() -> None:
    # Through (0,0), (1,1), (2,0) with zero end curvature: 1.5 x - 0.5 x^3 on the first piece.
    law = Table(times=(0.0, 1.0, 2.0), values=(0.0, 1.0, 0.0), interpolation="cubic")
    x = np.array([0.0, 0.25, 0.5, 1.0])
    assert_allclose([law(t) for t in x], 1.5 * x - 0.5 * x**3, rtol=1e-14, atol=1e-15)
    assert law(-5.0) == 0.0


@pytest.mark.parametrize(
    ("times", "values", "message"),
    [
        ((), (), "as many values"),
        ((0.0, 0.0), (1.0, 2.0), "must increase"),
        ((0.0,), (math.nan,), "not finite"),
    ],
)
def test_bad_tables(times: tuple[float, ...], values: tuple[float, ...], message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        Table(times=times, values=values)


def test_ramp_sine_and_sawtooth() -> None:
    assert [LAWS[4](t) for t in (0.0, 1.5, 7.0)] == [1.0, 2.0, 3.0]
    assert_allclose([LAWS[5](t) for t in (0.0, 1.0, 3.0)], [1.0, 3.0, -1.0], rtol=ROUNDING)
    assert_allclose([LAWS[6](t) for t in (0.0, 0.25, 0.75, 1.0)], [-1.0, -0.5, 0.5, -1.0], rtol=ROUNDING)
    triangle = Sawtooth(amplitude=1.0, frequency=1.0, width=0.5)
    assert_allclose([triangle(t) for t in (0.0, 0.25, 0.5, 0.75)], [-1.0, 0.0, 1.0, 0.0], atol=ROUNDING)


def test_constancy() -> None:
    assert [law.constant for law in LAWS] == [True, False, False, False, False, False, False, False]
    assert Expression("3*s").constant
    assert Table(times=(0.0, 1.0), values=(2.0, 2.0)).constant


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2*3 - 4/8", 6.5),
        ("-t**2", -9.0),
        ("2**-1", 0.5),
        ("min(t, 1, 2) + max(0, s)", 1.25),
        ("clip(t, 0, 2)", 2.0),
        ("  sin(pi/2) + log(e)", 2.0),
        ("step(t - 3) + step(t - 3.1)", 1.0),
        ("smoothstep(0.5)", 0.5),
        ("square(0.1) + square(4)", 0.0),
        ("sawtooth(pi, 0.5)", 1.0),
        ("floor(2.7) + abs(-1) + sqrt(4)", 5.0),
    ],
)
def test_expressions(text: str, value: float) -> None:
    assert_allclose(Expression(text)(3.0, 0.25), value, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("text", "column", "reason"),
    [
        ("t**t", 4, "an exponent must be a plain number"),
        ("9**9**9", 4, "an exponent must be a plain number"),
        ("t**99", 4, "an exponent may be at most 16 in size"),
        ("1 + sn(t)", 5, "unknown function 'sn'; did you mean 'sin'?"),
        ("1 + x", 5, "unknown name 'x'"),
        ("sin + 1", 1, "sin is a function: write sin(...)"),
        ("t ^ 2", 5, "'^' is not an operator here; write ** for a power"),
        ("__import__('os')", 1, "unknown function '__import__'"),
        ("t.real", 1, "only arithmetic on numbers, t and s is understood here"),
        ("[1][0]", 1, "only arithmetic on numbers, t and s is understood here"),
        ("t if t else 1", 1, "only arithmetic on numbers, t and s is understood here"),
        ("t > 1", 1, "only arithmetic on numbers, t and s is understood here"),
        ("sin(x=1)", 1, "only arithmetic on numbers, t and s is understood here"),
        ("2j", 1, "only plain numbers are understood here"),
        ("sin(t, 2)", 1, "sin takes 1 arguments, got 2"),
        ("1e999", 1, "number too large"),
        ("t +", 4, "not a complete expression"),
        ("π*t", 1, "unexpected character 'π'"),
        ("-" * 200 + "t", 102, "nested deeper than 100"),
        ("1+" * 800 + "1", 1001, "longer than 1000 characters"),
    ],
)
def test_refused_expressions(text: str, column: int, reason: str) -> None:
    with pytest.raises(ExpressionError) as error:
        compile_expression(text)
    assert (error.value.column, error.value.reason) == (column, reason)


def test_value_that_is_not_finite_is_an_error_with_its_time() -> None:
    with pytest.raises(LawError, match=r"log\(t\).* at t = 0 s"):
        Expression("log(t)")(0.0)


@given(st.text("ts0123456789.+-*/() sincoexpqrt,^", max_size=60))
def test_any_text_is_an_expression_or_an_error_with_a_column(text: str) -> None:
    column, value = None, 0.0
    try:
        value = float(Expression(text)(0.3, 0.7))
    except ExpressionError as error:
        column = error.column
    except LawError:
        value = 0.0
    assert column is None or 1 <= column <= len(text) + 2
    assert math.isfinite(value)


_TERMS = st.recursive(
    st.one_of(st.sampled_from(["t", "s", "pi"]), st.floats(0.5, 3.0).map(repr)),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*"]), inner).map(lambda p: f"({p[0]} {p[1]} {p[2]})"),
        inner.map(lambda p: f"sin({p})"),
        inner.map(lambda p: f"-({p})"),
        inner.map(lambda p: f"abs({p})**0.5"),
    ),
    max_leaves=8,
)


@given(_TERMS, st.floats(-2.0, 2.0), st.floats(0.0, 1.0))
def test_agrees_with_python(text: str, t: float, s: float) -> None:
    names = {"t": t, "s": s, "pi": math.pi, "sin": math.sin, "abs": abs, "__builtins__": {}}
    assert_allclose(Expression(text)(t, s), eval(text, names), rtol=1e-12, atol=1e-12)
