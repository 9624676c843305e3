"""Shells: from shape and material to stiffness arrays.

Moduli and thicknesses are one number, or an array of one for each triangle, edge or hinge.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from ..arrays import FloatArray, IntArray, Numbers
from ..geometry.vectors import dot
from ..mesh.measure import side_vectors, triangle_areas


def cubed(thickness: Numbers) -> FloatArray:
    """h^3, number by number: the power of a whole array rounds otherwise on some processors."""
    cubes: FloatArray = _CUBE(thickness)
    return cubes


_CUBE = np.vectorize(lambda h: h**3, otypes=[np.float64])


def plane_stress_stiffness(
    metric: FloatArray, youngs_modulus: Numbers, poisson_ratio: float, thickness: Numbers
) -> FloatArray:
    """Stiffness of metric strains, upper triangle by rows [N/m^3], shape (6, T).

    With the strain tensor G = sum eps_ab g^a g^b in the dual basis of the rest triangle, the energy
    h A [lambda tr(G)^2 / 2 + mu G:G] is eps.C.eps / 2 in eps = (eps_11, eps_22, 2 eps_12).

    Args:
        metric: Rest metric [m^2], shape (3, T).
        youngs_modulus: E [Pa].
        poisson_ratio: nu [1]; lambda = E nu / (1 - nu^2) of plane stress, mu = E / (2 (1 + nu)).
        thickness: h [m].
    """
    a, b, c = metric
    square = a * b - c * c  # (twice the area)^2
    g11, g22, g12 = b / square, a / square, -c / square
    volume = 0.5 * thickness * np.sqrt(square)
    first = volume * youngs_modulus * poisson_ratio / (1.0 - poisson_ratio**2)
    shear = volume * youngs_modulus / (1.0 + poisson_ratio)
    return np.stack(
        [
            (first + shear) * g11 * g11,
            first * g11 * g22 + shear * g12 * g12,
            (first + shear) * g11 * g12,
            (first + shear) * g22 * g22,
            (first + shear) * g22 * g12,
            first * g12 * g12 + 0.5 * shear * (g11 * g22 + g12 * g12),
        ]
    )


def area_springs(
    youngs_modulus: Numbers, thickness: Numbers, lengths: FloatArray, adjacent_area: FloatArray
) -> FloatArray:
    """Spring stiffness E h (A1 + A2) / l [N], shape (B,) (Van Gelder 1998).

    On nets of equilateral triangles the sheet has Young's modulus E and Poisson ratio 1/3, rims
    included.

    Args:
        youngs_modulus: E [Pa].
        thickness: h [m].
        lengths: Rest lengths l [m], shape (B,).
        adjacent_area: A1 + A2, or the one area at a rim edge [m^2], shape (B,).
    """
    return youngs_modulus * thickness * adjacent_area / lengths


def hinge_springs(youngs_modulus: Numbers, thickness: Numbers, lengths: FloatArray) -> FloatArray:
    """Spring stiffness (sqrt(3)/2) E h l [N], shape (B,), that the DiSMech family pairs with hinges.

    Equals :func:`area_springs` inside nets of equilateral triangles; rims are too stiff.
    """
    return 0.5 * sqrt(3.0) * youngs_modulus * thickness * lengths


def midedge_springs(
    youngs_modulus: Numbers, poisson_ratio: float, thickness: Numbers, lengths: FloatArray
) -> FloatArray:
    """Spring stiffness 2 E h l / (1 - nu^2) [N], shape (B,), the DiSMech family's for mid-edge bending.

    About 2.3 times a sheet of modulus E / (1 - nu^2): for comparison with the family's results only.
    """
    return 2.0 * youngs_modulus * thickness * lengths / (1.0 - poisson_ratio**2)


def hinge_stiffness(youngs_modulus: Numbers, thickness: Numbers, count: int) -> FloatArray:
    """Hinge stiffness (2/sqrt(3)) E h^3 / 12 [N m], shape (H,).

    On nets of equilateral triangles this is a plate with D = E h^3 / 12 and a bending Poisson ratio
    of -1/3 (Seung & Nelson 1988). On other nets it does not converge to a plate: a simply supported
    square deflects 0.71 (right triangles) to 1.16 (alternating) of the true value.
    """
    return np.full(count, youngs_modulus * cubed(thickness) / (6.0 * sqrt(3.0)))


def weighted_hinge_stiffness(
    youngs_modulus: Numbers, thickness: Numbers, lengths: FloatArray, adjacent_area: FloatArray
) -> FloatArray:
    """Hinge stiffness (E h^3 / 12) l^2 / (A1 + A2) [N m], shape (H,) (Grinspun et al. 2003).

    Equal to :func:`hinge_stiffness` on equilateral triangles; the weight evens out hinges of
    different shape but is no cure for other nets (0.56 to 0.77 of the true deflection).

    Args:
        youngs_modulus: E [Pa].
        thickness: h [m].
        lengths: Rest lengths of the hinge edges [m], shape (H,).
        adjacent_area: Areas of both faces [m^2], shape (H,).
    """
    return youngs_modulus * cubed(thickness) / 12.0 * lengths**2 / adjacent_area


def bending_stiffness(
    nodes: FloatArray, triangles: IntArray, youngs_modulus: Numbers, poisson_ratio: float, thickness: Numbers
) -> FloatArray:
    """Stiffness of the three edge angles of each triangle, upper triangle by rows [N m], (6, T).

    With alpha_i the angle between the face normal and the normal at the middle of edge i, the
    shape operator is sum_i alpha_i t_i t_i^T / (A l_i), t_i the outward in-plane normals of length
    l_i (Grinspun et al. 2006), and (D A / 2) [(1 - nu) tr(L^2) + nu tr(L)^2] is alpha.M.alpha / 2,
    D = E h^3 / (12 (1 - nu^2)).

    Args:
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        youngs_modulus: E [Pa].
        poisson_ratio: nu [1].
        thickness: h [m].
    """
    sides = side_vectors(nodes, triangles)
    area = triangle_areas(nodes, triangles)
    rigidity = youngs_modulus * cubed(thickness) / (12.0 * (1.0 - poisson_ratio**2))
    length = np.linalg.norm(sides, axis=2)
    entries = []
    for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
        # rotating both sides by a quarter turn leaves t_i.t_j = v_i.v_j
        inner = dot(sides[i].T, sides[j].T) ** 2 / (length[i] * length[j])
        trace = length[i] * length[j]
        entries.append(rigidity / area * ((1.0 - poisson_ratio) * inner + poisson_ratio * trace))
    return np.stack(entries)
