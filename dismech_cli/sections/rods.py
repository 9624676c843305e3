"""Cross-sections: from shape and material to the stiffness and inertia of a rod.

Director m1 spans the thickness, m2 the width: curvature 1 turns the tangent towards m1, so EI1 is
the stiffness about m2. Sizes and moduli may be numbers or arrays of one shape: a section for each place.
"""

from __future__ import annotations

from math import pi

import numpy as np

from ..arrays import FloatArray, Numbers
from ..frozen import frozen


@frozen
class Section:
    """Geometry of a cross-section.

    Attributes:
        area: A [m^2].
        inertia_1: Second moment for curvature 1, bending towards m1 [m^4].
        inertia_2: Second moment for curvature 2, bending towards m2 [m^4].
        torsion: Torsion constant J [m^4].
        radius: Radius of the drawn tube [m].
    """

    area: Numbers
    inertia_1: Numbers
    inertia_2: Numbers
    torsion: Numbers
    radius: Numbers


@frozen
class RodProperties:
    """Stiffness and inertia of the edges of a rod, each an array of shape (E,).

    Attributes:
        axial: EA [N].
        bending_1: EI1 [N m^2].
        bending_2: EI2 [N m^2].
        torsional: GJ [N m^2].
        mass_per_length: rho A [kg/m].
        polar_per_length: rho (I1 + I2) [kg m]: rotary inertia about the tangent.
        area: A [m^2]: the volume per length that buoyancy displaces.
        radius: Radius of the drawn tube [m].
    """

    axial: FloatArray
    bending_1: FloatArray
    bending_2: FloatArray
    torsional: FloatArray
    mass_per_length: FloatArray
    polar_per_length: FloatArray
    area: FloatArray
    radius: FloatArray

    @property
    def isotropic(self) -> bool:
        """Equal bending stiffness in all directions."""
        return bool((self.bending_1 == self.bending_2).all())


def round_section(radius: Numbers) -> Section:
    """Solid circle."""
    inertia = pi * radius**4 / 4.0
    return Section(pi * radius**2, inertia, inertia, 2.0 * inertia, radius)


def tube_section(outer: Numbers, inner: Numbers) -> Section:
    """Annulus."""
    inertia = pi * (outer**4 - inner**4) / 4.0
    return Section(pi * (outer**2 - inner**2), inertia, inertia, 2.0 * inertia, outer)


def rectangular_section(width: Numbers, thickness: Numbers, torsion: Numbers | None = None) -> Section:
    """Rectangle, thickness along m1 and width along m2.

    Args:
        width: Side along m2 [m].
        thickness: Side along m1 [m].
        torsion: Torsion constant [m^4]; by default Saint-Venant's value to 0.5 %, a b^3 [1/3 -
            0.21 (b/a)(1 - b^4/(12 a^4))] for sides a >= b (Roark's Formulas, table 10.7).
    """
    a, b = np.maximum(width, thickness), np.minimum(width, thickness)
    saint_venant = a * b**3 * (1.0 / 3.0 - 0.21 * (b / a) * (1.0 - b**4 / (12.0 * a**4)))
    return Section(
        width * thickness,
        width * thickness**3 / 12.0,
        thickness * width**3 / 12.0,
        saint_venant if torsion is None else torsion,
        0.5 * b,
    )


def rod_properties(
    section: Section, youngs_modulus: Numbers, poisson_ratio: Numbers, density: Numbers
) -> RodProperties:
    """Stiffness and inertia of a rod, in arrays of the shape of what they are made of.

    Args:
        section: Cross-section.
        youngs_modulus: E [Pa].
        poisson_ratio: nu [1]; G = E / (2 (1 + nu)).
        density: rho [kg/m^3].
    """
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poisson_ratio))
    return RodProperties(
        axial=np.asarray(youngs_modulus * section.area),
        bending_1=np.asarray(youngs_modulus * section.inertia_1),
        bending_2=np.asarray(youngs_modulus * section.inertia_2),
        torsional=np.asarray(shear_modulus * section.torsion),
        mass_per_length=np.asarray(density * section.area),
        polar_per_length=np.asarray(density * (section.inertia_1 + section.inertia_2)),
        area=np.asarray(section.area),
        radius=np.asarray(section.radius),
    )
