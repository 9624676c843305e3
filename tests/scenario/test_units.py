"""Quantities as text."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from dismech_cli.quantities import QuantityError, parse_quantity, read_quantity
from dismech_cli.units import KINDS, UNITS

ROUNDING = 4e-16  # a product or two in double precision


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("2 MPa", "pressure", 2e6),
        ("5 mm", "length", 5e-3),
        ("5mm", "length", 5e-3),
        ("1.2 g/cm^3", "density", 1200.0),
        ("30 deg", "angle", math.pi / 6),
        ("1 %", "ratio", 0.01),
        ("0.1 N*s/m^2", "viscosity", 0.1),
        ("0.1 N s/m^2", "viscosity", 0.1),
        ("0.1 Pa*s", "viscosity", 0.1),
        ("3 1/m", "curvature", 3.0),
        ("3/cm", "curvature", 300.0),
        ("2 rad/m", "curvature", 2.0),
        ("2 1/m", "twist rate", 2.0),
        ("9.81 m/s^2", "acceleration", 9.81),
        ("9.81 m/s/s", "acceleration", 9.81),
        ("9.81 m s^-2", "acceleration", 9.81),
        ("4 kg/(m*s^2)", "pressure", 4.0),
        ("1 mN*mm", "moment", 1e-6),
        ("2e-3 kHz", "frequency", 2.0),
        ("-.5 µm", "length", -5e-7),
        ("1 mm²", "area", 1e-6),
        ("1 mm**2", "area", 1e-6),
        ("2e6", "pressure", 2e6),
        ("1 min", "time", 60.0),
        ("1000 kg/m3", "density", 1000.0),
        ("2 N/mm2", "pressure", 2e6),
        ("9.81 m s-2", "acceleration", 9.81),
        ("2 in", "length", 0.0508),
        ("1 psi", "pressure", 6894.757293168361),
        ("3 t", "mass", 3000.0),
        ("7 N/m", "force per length", 7.0),
    ],
)
def test_right_quantities(text: str, kind: str, value: float) -> None:
    assert_allclose(parse_quantity(text, KINDS[kind]), value, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("2 mm", "pressure", "expected a pressure such as '1 Pa', got a length, '2 mm'"),
        ("2 Mpa", "pressure", "unknown unit 'Mpa' in '2 Mpa'; did you mean 'MPa'?"),
        ("1 mpa", "pressure", "unknown unit 'mpa' in '1 mpa'; did you mean 'MPa' or 'mPa'?"),
        ("1 inn", "length", "unknown unit 'inn' in '1 inn'; did you mean 'in'?"),
        ("1 mi", "time", "unknown unit 'mi' in '1 mi'; did you mean 'min'?"),
        ("1 Tw", "mass", "unknown unit 'Tw' in '1 Tw'; did you mean 't'?"),
        ("1 9m", "length", "cannot read the unit '9m' of '1 9m'"),
        ("1 m2.5", "area", "cannot read the unit 'm2.5' of '1 m2.5'"),
        ("30 deg", "ratio", "expected a plain number, got an angle, '30 deg'"),
        ("2 rad/s", "frequency", "expected a frequency such as '1 Hz', got an angular velocity, '2 rad/s'"),
        ("soft", "pressure", "expected a pressure such as '1 Pa', got 'soft'"),
        ("1 kg*m^5", "mass", "expected a mass such as '1 kg', got a quantity in m^5 kg, '1 kg*m^5'"),
        ("1 N/m s", "force", "unclear unit in '1 N/m s': write N/(m*s) or N*s/m"),
        ("1 m^99", "length", "exponent too large in '1 m^99'"),
        ("9**9**9 m", "length", "cannot read the unit of '9**9**9 m'"),
        ("1 (m", "length", "cannot read the unit of '1 (m'"),
        ("1e999 m", "length", "'1e999 m' is too large"),
        ("nan", "length", "expected a length such as '1 m', got 'nan'"),
        ("1_000 m", "length", "cannot read the unit '_000 m' of '1_000 m'"),
        ("", "length", "expected a length such as '1 m', got ''"),
    ],
)
def test_wrong_quantities(text: str, kind: str, message: str) -> None:
    with pytest.raises(QuantityError) as error:
        parse_quantity(text, KINDS[kind])
    assert str(error.value) == message


@given(st.floats(-1e30, 1e30), st.sampled_from(sorted(UNITS)))
def test_any_number_with_any_unit(number: float, unit: str) -> None:
    value, dimension = read_quantity(f"{number!r} {unit}")
    factor, expected = UNITS[unit]
    assert dimension == expected
    assert_allclose(value, number * factor, rtol=ROUNDING)


@given(st.text(max_size=100))
def test_any_text_is_a_quantity_or_a_quantity_error(text: str) -> None:
    value, message = 0.0, "none"
    try:
        value, _ = read_quantity(text)
    except QuantityError as error:
        message = str(error)
    assert math.isfinite(value)
    assert message
