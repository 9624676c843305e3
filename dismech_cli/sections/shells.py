"""Shells: from shape and material to stiffness arrays and lumped mass."""

from __future__ import annotations

from math import sqrt

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kinematics.dofs import DofMap


def triangle_areas(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Areas [m^2], shape (T,)."""
    x0, x1, x2 = (nodes[triangles[:, k]] for k in range(3))
    areas: FloatArray = 0.5 * np.linalg.norm(np.cross(x1 - x0, x2 - x0), axis=1)
    return areas


def edge_lengths(nodes: FloatArray, edges: IntArray) -> FloatArray:
    """Lengths [m], shape (B,)."""
    lengths: FloatArray = np.linalg.norm(nodes[edges[:, 1]] - nodes[edges[:, 0]], axis=1)
    return lengths


def nodal_areas(n_nodes: int, triangles: IntArray, areas: FloatArray) -> FloatArray:
    """A third of the area of every adjacent triangle [m^2], shape (n_nodes,)."""
    shares = np.bincount(triangles.reshape(-1), np.repeat(areas / 3.0, 3), minlength=n_nodes)
    return np.asarray(shares, dtype=np.float64)


def shell_mass(dofs: DofMap, triangles: IntArray, areas: FloatArray, per_area: FloatArray) -> FloatArray:
    """Diagonal of the mass matrix, shape (n,): a third of each triangle at its corners.

    Args:
        dofs: Numbering.
        triangles: Shape (T, 3).
        areas: Rest areas [m^2], shape (T,).
        per_area: Mass per area rho h [kg/m^2], shape (T,).
    """
    mass = np.zeros(dofs.n)
    nodal = nodal_areas(dofs.n_nodes, triangles, areas * per_area)
    mass[: dofs.n_positions] = np.repeat(nodal, dofs.dimension)
    return mass


def rest_metric(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Metric (a.a, b.b, a.b) of a = x1 - x0, b = x2 - x0 [m^2], shape (3, T)."""
    a = nodes[triangles[:, 1]] - nodes[triangles[:, 0]]
    b = nodes[triangles[:, 2]] - nodes[triangles[:, 0]]
    return np.stack([_dot(a, a), _dot(b, b), _dot(a, b)])


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    # the order of sums of the kernels: the rest shape is then stress-free to the last bit
    product: FloatArray = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]
    return product


def plane_stress_stiffness(
    metric: FloatArray, youngs_modulus: float, poisson_ratio: float, thickness: float
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
    youngs_modulus: float, thickness: float, lengths: FloatArray, adjacent_area: FloatArray
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


def hinge_springs(youngs_modulus: float, thickness: float, lengths: FloatArray) -> FloatArray:
    """Spring stiffness (sqrt(3)/2) E h l [N], shape (B,), that the DiSMech family pairs with hinges.

    Equals :func:`area_springs` inside nets of equilateral triangles; rims are too stiff.
    """
    return 0.5 * sqrt(3.0) * youngs_modulus * thickness * lengths


def midedge_springs(
    youngs_modulus: float, poisson_ratio: float, thickness: float, lengths: FloatArray
) -> FloatArray:
    """Spring stiffness 2 E h l / (1 - nu^2) [N], shape (B,), the DiSMech family's for mid-edge bending.

    About 2.3 times a sheet of modulus E / (1 - nu^2): for comparison with the family's results only.
    """
    return 2.0 * youngs_modulus * thickness * lengths / (1.0 - poisson_ratio**2)


def adjacent_areas(edge_faces: IntArray, areas: FloatArray) -> FloatArray:
    """Sum of the areas of the one or two triangles at each edge [m^2], shape (B,).

    Args:
        edge_faces: Triangles at each edge, -1 where there is no second, shape (B, 2).
        areas: Shape (T,).
    """
    second = np.where(edge_faces[:, 1] >= 0, areas[edge_faces[:, 1]], 0.0)
    total: FloatArray = areas[edge_faces[:, 0]] + second
    return total


def hinge_stiffness(youngs_modulus: float, thickness: float, count: int) -> FloatArray:
    """Hinge stiffness (2/sqrt(3)) E h^3 / 12 [N m], shape (H,).

    On nets of equilateral triangles this is a plate with D = E h^3 / 12 and a bending Poisson ratio
    of -1/3 (Seung & Nelson 1988). On other nets it does not converge to a plate: a simply supported
    square deflects 0.71 (right triangles) to 1.16 (alternating) of the true value.
    """
    return np.full(count, youngs_modulus * thickness**3 / (6.0 * sqrt(3.0)))


def weighted_hinge_stiffness(
    youngs_modulus: float, thickness: float, lengths: FloatArray, adjacent_area: FloatArray
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
    return youngs_modulus * thickness**3 / 12.0 * lengths**2 / adjacent_area


def bending_stiffness(
    nodes: FloatArray, triangles: IntArray, youngs_modulus: float, poisson_ratio: float, thickness: float
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
    sides = _sides(nodes, triangles)
    area = triangle_areas(nodes, triangles)
    rigidity = youngs_modulus * thickness**3 / (12.0 * (1.0 - poisson_ratio**2))
    length = np.linalg.norm(sides, axis=2)
    entries = []
    for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
        # rotating both sides by a quarter turn leaves t_i.t_j = v_i.v_j
        inner = _dot(sides[i], sides[j]) ** 2 / (length[i] * length[j])
        trace = length[i] * length[j]
        entries.append(rigidity / area * ((1.0 - poisson_ratio) * inner + poisson_ratio * trace))
    return np.stack(entries)


def angles_of_curvature(nodes: FloatArray, triangles: IntArray, curvature: FloatArray) -> FloatArray:
    """Edge angles [rad], shape (3, T), of triangles whose shape operator is ``curvature``.

    Args:
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        curvature: Symmetric tensors [1/m], shape (T, 3, 3); positive where normals diverge (a
            sphere with outward normals). Their parts across the triangle do not count.
    """
    sides = _sides(nodes, triangles)
    along = np.einsum("kti,tij,ktj->kt", sides, curvature, sides)
    length = np.linalg.norm(sides, axis=2)
    angles: FloatArray = length * (along.sum(axis=0) - 2.0 * along) / (8.0 * triangle_areas(nodes, triangles))
    return angles


def _sides(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Sides opposite the corners, counter-clockwise [m], shape (3, T, 3)."""
    x = [nodes[triangles[:, k]] for k in range(3)]
    return np.stack([x[2] - x[1], x[0] - x[2], x[1] - x[0]])
