"""Bending of a shell by averaged mid-edge normals: the energy of ``midedge`` without its unknowns.

The normal at the middle of an edge is halfway between those of its two faces, so alpha_i is half
the dihedral angle: a stencil of a triangle (x0, x1, x2) and the corners f0, f1, f2 of its three
neighbours, f_i across the side opposite x_i. At a rim the normal is the face's own, alpha_i = 0,
and f_i is any node. A third of the unknowns of free normals, but rims are too stiff.

Parameters per stencil, after the natural dihedral angles [rad]: upper triangle of M by rows [N m],
share of each dihedral angle [1]: 1/2, or 0 at a rim.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray, Numbers
from ..geometry.blocks import add_block, add_symmetric, outer_sum, pack_five, symmetric_outer_sum, two_sided
from ..geometry.kernel import kernel
from ..geometry.triangle import azimuth_gradient, azimuth_hessian, dihedral_angle, fold, nearest_turn, side
from ..geometry.vectors import add, combine, cross, norm, outer, scale, sub, sym_outer
from ..kernels.shape import Kernel
from ..kinematics.dofs import DofMap
from ..model.stencil import StencilEnergy
from ..sections.shells import bending_stiffness
from .midedge import face_turning


@kernel
def around(y: Any) -> Any:
    """Edge vectors, those to the neighbours' corners, the normal, and what all angles stand on."""
    a, b = y[0:3], y[3:6]
    v0, v1 = sub(b, a), scale(-1.0, b)
    f0, f1, f2 = sub(y[6:9], a), sub(y[9:12], b), y[12:15]
    n = cross(a, b)
    inverse_area = 1.0 / norm(n)
    n = scale(inverse_area, n)
    sides = (
        side(v0, scale(-1.0, a), inverse_area),
        side(v1, sub(a, b), inverse_area),
        side(a, b, inverse_area),
    )
    # neighbour 0 turns about b - a, seen from a; neighbour 1 about -b, seen from b; 2 about a
    others = (azimuth_gradient(v0, f0), azimuth_gradient(v1, f1), azimuth_gradient(a, f2))
    return (a, b, v0, v1), (f0, f1, f2), n, sides, others


@kernel
def by_angles(shape: Any, m: Any, k: Any) -> Any:
    """Gradient and packed Hessian of an energy of the dihedral angles.

    Args:
        shape: From :func:`around`.
        m: Derivatives to the angles.
        k: Second derivatives to them, upper triangle by rows.
    """
    (a, b, v0, v1), (f0, f1, f2), n, (side0, side1, side2), others = shape
    (n0, s0, c0, r0), (n1, s1, c1, r1), (n2, s2, c2, r2) = others
    m0, m1, m2 = m
    k00, k01, k02, k11, k12, k22 = k

    # dihedral angle = azimuth of the neighbour less that of the triangle itself
    g0, g1, g2 = side0[1] * side0[2], side1[1] * side1[2], side2[1] * side2[2]
    h0, h1, h2 = s0 * c0, s1 * c1, s2 * c2
    a0, b0 = combine(h0 - s0, n0, side0[1] - g0, n), combine(-h0, n0, g0, n)
    a1, b1 = scale(-side1[1], n), combine(h1 - s1, n1, side1[1] - g1, n)
    a2, b2 = combine(-h2, n2, g2, n), scale(-side2[1], n)
    ga = combine(m0, a0, 1.0, combine(m1, a1, m2, a2))
    gb = combine(m0, b0, 1.0, combine(m1, b1, m2, b2))
    gc, gd, ge = scale(m0 * s0, n0), scale(m1 * s1, n1), scale(m2 * s2, n2)
    gradient = (
        ga[0], ga[1], ga[2], gb[0], gb[1], gb[2],
        gc[0], gc[1], gc[2], gd[0], gd[1], gd[2], ge[0], ge[1], ge[2],
    )  # fmt: skip

    q0 = add(scale(k00, a0), combine(k01, a1, k02, a2))
    q1 = add(scale(k01, a0), combine(k11, a1, k12, a2))
    q2 = add(scale(k02, a0), combine(k12, a1, k22, a2))
    u0 = add(scale(k00, b0), combine(k01, b1, k02, b2))
    u1 = add(scale(k01, b0), combine(k11, b1, k12, b2))
    u2 = add(scale(k02, b0), combine(k12, b1, k22, b2))
    haa, hab, hbb = face_turning(a, b, n, side0, side1, side2, (-m0, -m1, -m2))

    x0, y0, l0, z0 = azimuth_hessian(v0, f0, s0, c0, r0, m0)
    x1, y1, l1, z1 = azimuth_hessian(v1, f1, s1, c1, r1, m1)
    x2, y2, l2, z2 = azimuth_hessian(a, f2, s2, c2, r2, m2)
    yz0, yz1, lz0, lz1 = add(y0, z0), add(y1, z1), add(l0, z0), add(l1, z1)
    xl0 = add(x0, l0)
    # own part of each neighbour, of the triangle, and the rank-one parts
    aa = add_symmetric(sym_outer(n0, add(xl0, yz0)), sym_outer(n2, x2))
    bb = add_symmetric(sym_outer(n1, add(add(x1, l1), yz1)), sym_outer(n0, x0))
    ab = two_sided(n0, scale(-1.0, xl0), scale(-1.0, add(x0, y0)))
    aa = add_symmetric(add_symmetric(aa, haa), symmetric_outer_sum((a0, a1, a2), (q0, q1, q2)))
    bb = add_symmetric(add_symmetric(bb, hbb), symmetric_outer_sum((b0, b1, b2), (u0, u1, u2)))
    ab = add_block(add_block(ab, hab), outer_sum((a0, a1, a2), (u0, u1, u2)))
    hessian = pack_five(
        (
            aa,
            bb,
            sym_outer(n0, combine(1.0, z0, 0.5 * k00 * s0 * s0, n0)),
            sym_outer(n1, combine(1.0, z1, 0.5 * k11 * s1 * s1, n1)),
            sym_outer(n2, combine(1.0, z2, 0.5 * k22 * s2 * s2, n2)),
        ),
        (
            ab,
            two_sided(n0, scale(-1.0, yz0), combine(s0, q0, -1.0, lz0)),
            outer(scale(s1, q1), n1),
            two_sided(n2, y2, combine(1.0, l2, s2, q2)),
            two_sided(n0, y0, combine(1.0, l0, s0, u0)),
            two_sided(n1, scale(-1.0, yz1), combine(s1, u1, -1.0, lz1)),
            outer(scale(s2, u2), n2),
            outer(scale(k01 * s0 * s1, n0), n1),
            outer(scale(k02 * s0 * s2, n0), n2),
            outer(scale(k12 * s1 * s2, n1), n2),
        ),
    )
    return gradient, hessian


@kernel
def midedge_averaged(y: Any, x: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (x1, x2, f0, f1, f2) - x0."""
    p00, p01, p02, p11, p12, p22, w0, w1, w2 = p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11]
    shape = around(y)
    _, (f0, f1, f2), n, _, ((n0, s0, _, _), (n1, s1, _, _), (n2, s2, _, _)) = shape
    e0 = w0 * nearest_turn(fold(n, n0, f0, s0) - p[0])
    e1 = w1 * nearest_turn(fold(n, n1, f1, s1) - p[1])
    e2 = w2 * nearest_turn(fold(n, n2, f2, s2) - p[2])
    m0, m1, m2 = (
        p00 * e0 + p01 * e1 + p02 * e2,
        p01 * e0 + p11 * e1 + p12 * e2,
        p02 * e0 + p12 * e1 + p22 * e2,
    )
    energy = 0.5 * (e0 * m0 + e1 * m1 + e2 * m2)
    k00, k01, k02 = w0 * w0 * p00, w0 * w1 * p01, w0 * w2 * p02
    k11, k12, k22 = w1 * w1 * p11, w1 * w2 * p12, w2 * w2 * p22
    gradient, hessian = by_angles(shape, (w0 * m0, w1 * m1, w2 * m2), (k00, k01, k02, k11, k12, k22))
    return energy, gradient, hessian


_NATURAL = ("theta_0", "theta_1", "theta_2")
_STIFFNESS = ("M00", "M01", "M02", "M11", "M12", "M22")
_SHARES = ("share_0", "share_1", "share_2")
MIDEDGE_AVERAGED = Kernel(
    midedge_averaged,
    dimension=3,
    nodes=6,
    vectors=((0, 1), (0, 2), (0, 3), (0, 4), (0, 5)),
    naturals=_NATURAL,
    constants=_STIFFNESS + _SHARES,
    scales=(("M00", "M01", "M02"), ("M01", "M11", "M12"), ("M02", "M12", "M22")),
)


def neighbour_corners(triangles: IntArray, face_edges: IntArray, edge_faces: IntArray) -> IntArray:
    """Node across each side, or the triangle's own opposite corner at a rim, shape (T, 3).

    Args:
        triangles: Shape (T, 3).
        face_edges: Shell edge opposite each corner, shape (T, 3).
        edge_faces: Triangles at each edge, -1 where there is no second, shape (B, 2).
    """
    pair = edge_faces[face_edges]
    own = np.arange(len(triangles))[:, None]
    other = np.where(pair[:, :, 0] == own, pair[:, :, 1], pair[:, :, 0])
    # The corner across is the one opposite the shared edge in the neighbour.
    opposite = face_edges[other] == face_edges[:, :, None]
    across: IntArray = triangles[other, np.argmax(opposite, axis=2)]
    return np.where(other >= 0, across, triangles)


def midedge_averaged_term(
    name: str,
    dofs: DofMap,
    nodes: FloatArray,
    triangles: IntArray,
    face_edges: IntArray,
    edge_faces: IntArray,
    *,
    youngs_modulus: Numbers,
    poisson_ratio: float,
    thickness: Numbers,
) -> StencilEnergy:
    """Build the bending energy of a shell by averaged mid-edge normals, stress-free in the rest shape.

    Args:
        name: Unique name.
        dofs: Numbering.
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        face_edges: Shell edge opposite each corner, shape (T, 3).
        edge_faces: Triangles at each edge, -1 where there is no second, shape (B, 2).
        youngs_modulus: E [Pa].
        poisson_ratio: nu [1].
        thickness: h [m].

    Returns:
        Energy with one stencil per triangle; its natural strains (3, T) are the dihedral angles
        [rad] at its sides: twice ``sections.shells.angles_of_curvature``.
    """
    corners = neighbour_corners(triangles, face_edges, edge_faces)
    rim = edge_faces[face_edges][:, :, 1] < 0
    x = [nodes[triangles[:, k]].T for k in range(3)]
    natural = [
        dihedral_angle(x[k - 1] - x[k - 2], x[k] - x[k - 2], nodes[corners[:, k]].T - x[k - 2])
        for k in range(3)
    ]
    stiffness = bending_stiffness(nodes, triangles, youngs_modulus, poisson_ratio, thickness)
    shares = np.where(rim, 0.0, 0.5).T
    stencils = np.concatenate((triangles, corners), axis=1)
    return StencilEnergy.of(
        name,
        MIDEDGE_AVERAGED,
        dofs.of_nodes(stencils).reshape(len(triangles), -1),
        {
            **dict(zip(_NATURAL, natural, strict=True)),
            **dict(zip(_STIFFNESS, stiffness, strict=True)),
            **dict(zip(_SHARES, shares, strict=True)),
        },
    )
