"""Cross-sections against handbook values."""

from __future__ import annotations

from math import pi

import pytest
from numpy.testing import assert_allclose

from dismech_cli.sections.rods import rectangular_section, rod_properties, round_section, tube_section


def test_round_section() -> None:
    s = round_section(2.0)
    assert_allclose(
        [s.area, s.inertia_1, s.inertia_2, s.torsion], [4 * pi, 4 * pi, 4 * pi, 8 * pi], rtol=1e-15
    )


def test_thin_tube_is_a_ring() -> None:
    """For a thin wall h: A = 2 pi r h, I = pi r^3 h, J = 2 I, with error O(h/r)^2 at mid-radius."""
    r, h = 1.0, 1e-4
    s = tube_section(r + h / 2, r - h / 2)
    assert_allclose(
        [s.area, s.inertia_1, s.torsion], [2 * pi * r * h, pi * r**3 * h, 2 * pi * r**3 * h], rtol=1e-8
    )


def test_solid_tube_is_round() -> None:
    assert tube_section(0.3, 0.0) == round_section(0.3)


def test_rectangle_bends_easily_along_its_thickness() -> None:
    """Width 20 mm along m2, thickness 1 mm along m1: EI1 = E b h^3 / 12 is the soft one."""
    s = rectangular_section(width=0.02, thickness=0.001)
    assert_allclose(s.inertia_1, 0.02 * 1e-9 / 12, rtol=1e-15)
    assert_allclose(s.inertia_2, 0.001 * 8e-6 / 12, rtol=1e-15)


@pytest.mark.parametrize(
    ("ratio", "coefficient"),
    # Saint-Venant's series, Timoshenko & Goodier, Theory of Elasticity, table of k1 in article 109
    [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (5.0, 0.291), (10.0, 0.312)],
)
def test_torsion_constant_of_rectangles(ratio: float, coefficient: float) -> None:
    """J = k1 a b^3 to the half percent that the formula promises, either way round."""
    wide, thick = rectangular_section(ratio, 1.0), rectangular_section(1.0, ratio)
    assert_allclose(wide.torsion, coefficient * ratio, rtol=5e-3)
    assert wide.torsion == thick.torsion


def test_given_torsion_constant_wins() -> None:
    assert rectangular_section(0.02, 0.001, torsion=1.5e-12).torsion == 1.5e-12


def test_rod_properties() -> None:
    p = rod_properties(
        rectangular_section(0.02, 0.001), youngs_modulus=2e6, poisson_ratio=0.5, density=1200.0
    )
    assert_allclose(p.axial, 40.0, rtol=1e-14)
    assert_allclose([p.bending_1, p.bending_2], [10.0 / 3.0 * 1e-6, 4.0 / 3.0 * 1e-3], rtol=1e-14)
    assert_allclose(p.mass_per_length, 0.024, rtol=1e-14)
    assert_allclose(p.polar_per_length, 1200.0 * (0.02 * 1e-9 + 0.001 * 8e-6) / 12, rtol=1e-14)
    assert not p.isotropic
    assert rod_properties(round_section(1.0), 1.0, 0.5, 1.0).isotropic


def test_shear_modulus() -> None:
    """G = E / (2 (1 + nu)): a third of E at nu = 1/2."""
    p = rod_properties(round_section(1.0), youngs_modulus=3.0, poisson_ratio=0.5, density=1.0)
    assert_allclose(p.torsional, pi / 2, rtol=1e-15)
