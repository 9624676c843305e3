"""Bending of a shell by mid-edge normals: E = alpha.M.alpha / 2 on each triangle.

alpha_i is the angle about edge i from the face normal to the normal at the middle of that edge; the
three angles make the shape operator (Grinspun et al. 2006). Only angles between directions of the
same state enter, so rigid rotations cost nothing, whatever the rest shape.

The mid-edge normal is a degree of freedom: xi turns the normal stored at the start of the step,
parallel-transported with its edge, about that edge. Both faces of an edge see the same transported
normal, so its choice cancels wherever dE/dxi = 0. Gradient and Hessian include the transport.

Parameters per stencil, after the natural angles [rad]: upper triangle of M by rows [N m], sign of
each edge's stored direction against the face's. Auxiliary inputs per edge: tangent (3) and normal
(3) stored, xi stored.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray, Numbers
from ..geometry.blocks import add_block, add_symmetric, outer_sum, pack_two, symmetric_outer_sum, two_sided
from ..geometry.kernel import kernel
from ..geometry.rotation import parallel_transport, signed_angle
from ..geometry.triangle import azimuth_hessian, side
from ..geometry.vectors import (
    Vector,
    add,
    combine,
    combine_block,
    cross,
    dot,
    expand,
    norm,
    scale,
    sub,
    sym_outer,
)
from ..kernels.shape import Kernel
from ..kinematics.dofs import DofMap
from ..kinematics.shell_frames import ShellFrames
from ..model.stencil import StencilEnergy
from ..sections.shells import bending_stiffness


@kernel
def transported_angle(v: Vector, n: Vector, length: Any, tangent: Vector, normal: Vector) -> Any:
    """Angle about edge v from the transported normal to the face normal n, and the transport's share.

    Returns:
        The angle [rad]; the spin of the transported normal about v per change of v [1/m]: both
        vanish where v is still along ``tangent``.
    """
    t = scale(1.0 / length, v)
    r = parallel_transport(normal, tangent, t)
    spin = scale(-1.0 / (length * (length + dot(tangent, v))), cross(tangent, v))
    return signed_angle(r, n, t), spin


@kernel
def spin_slope(v: Vector, length: Any, tangent: Vector, spin: Vector, m: Any) -> Any:
    """Symmetric part of -m times the derivative of the spin with respect to v, packed [1/m^2]."""
    s = dot(tangent, v)
    w = -0.5 * m / (length * (length + s))
    return sym_outer(spin, combine(w * (2.0 + s / length), v, w * length, tangent))


@kernel
def face_turning(a: Vector, b: Vector, n: Vector, side0: Any, side1: Any, side2: Any, t: Any) -> Any:
    """Hessian of t0 psi_0 + t1 psi_1 + t2 psi_2 with respect to (a, b): blocks aa, ab, bb.

    psi_i is the azimuth of the face about its side i: sides b - a, -b, a, each seen from its tail.

    Args:
        a: Edge vector x1 - x0.
        b: Edge vector x2 - x0.
        n: Unit normal.
        side0: Of the first side, from :func:`side`; likewise ``side1`` and ``side2``.
        side1: See ``side0``.
        side2: See ``side0``.
        t: The three weights.
    """
    x0, y0, w0, z0 = azimuth_hessian(sub(b, a), scale(-1.0, a), side0[1], side0[2], side0[3], t[0])
    x1, y1, w1, z1 = azimuth_hessian(scale(-1.0, b), sub(a, b), side1[1], side1[2], side1[3], t[1])
    x2, y2, w2, z2 = azimuth_hessian(a, b, side2[1], side2[2], side2[3], t[2])
    # b - a and -a move together with a; a - b and -b with b
    xw0, yz0, yz1 = add(x0, w0), add(y0, z0), add(y1, z1)
    wz1 = add(w1, z1)
    aa = add(add(x2, z1), add(xw0, yz0))
    bb = add(add(z2, x0), add(add(x1, w1), yz1))
    right = sub(y2, add(wz1, xw0))
    left = sub(w2, add(yz1, add(x0, y0)))
    return sym_outer(n, aa), two_sided(n, right, left), sym_outer(n, bb)


@kernel
def midedge(y: Any, x: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (x1 - x0, x2 - x0, xi_0, xi_1, xi_2)."""
    a, b = y[0:3], y[3:6]
    p00, p01, p02, p11, p12, p22, r0, r1, r2 = p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11]
    v0, v1 = sub(b, a), scale(-1.0, b)
    d0, d1, d2 = scale(r0, x[0:3]), scale(r1, x[7:10]), scale(r2, x[14:17])
    n = cross(a, b)
    inverse_area = 1.0 / norm(n)
    n = scale(inverse_area, n)
    side0, side1, side2 = (
        side(v0, scale(-1.0, a), inverse_area),
        side(v1, sub(a, b), inverse_area),
        side(a, b, inverse_area),
    )
    psi0, s0 = transported_angle(v0, n, side0[0], d0, x[3:6])
    psi1, s1 = transported_angle(v1, n, side1[0], d1, x[10:13])
    psi2, s2 = transported_angle(a, n, side2[0], d2, x[17:20])
    e0 = r0 * (y[6] - x[6]) - psi0 - p[0]
    e1 = r1 * (y[7] - x[13]) - psi1 - p[1]
    e2 = r2 * (y[8] - x[20]) - psi2 - p[2]
    m0 = p00 * e0 + p01 * e1 + p02 * e2
    m1 = p01 * e0 + p11 * e1 + p12 * e2
    m2 = p02 * e0 + p12 * e1 + p22 * e2

    # slopes of -alpha: of the face normal less those of the transported normal
    g0, g1, g2 = side0[1] * side0[2], side1[1] * side1[2], side2[1] * side2[2]
    a0, b0 = combine(g0 - side0[1], n, 1.0, s0), combine(-g0, n, -1.0, s0)
    a1, b1 = scale(side1[1], n), combine(g1 - side1[1], n, 1.0, s1)
    a2, b2 = combine(-g2, n, -1.0, s2), scale(side2[1], n)
    ga = combine(-m0, a0, -1.0, combine(m1, a1, m2, a2))
    gb = combine(-m0, b0, -1.0, combine(m1, b1, m2, b2))
    q0 = add(scale(p00, a0), combine(p01, a1, p02, a2))
    q1 = add(scale(p01, a0), combine(p11, a1, p12, a2))
    q2 = add(scale(p02, a0), combine(p12, a1, p22, a2))
    u0 = add(scale(p00, b0), combine(p01, b1, p02, b2))
    u1 = add(scale(p01, b0), combine(p11, b1, p12, b2))
    u2 = add(scale(p02, b0), combine(p12, b1, p22, b2))

    haa, hab, hbb = face_turning(a, b, n, side0, side1, side2, (-m0, -m1, -m2))
    c0 = spin_slope(v0, side0[0], d0, s0, m0)
    c1 = spin_slope(v1, side1[0], d1, s1, m1)
    c2 = spin_slope(a, side2[0], d2, s2, m2)
    aa = add_symmetric(haa, add_symmetric(c0, c2))
    bb = add_symmetric(hbb, add_symmetric(c0, c1))
    ab = combine_block(1.0, hab, -1.0, expand(c0))
    h = pack_two(
        add_symmetric(aa, symmetric_outer_sum((a0, a1, a2), (q0, q1, q2))),
        add_block(ab, outer_sum((a0, a1, a2), (u0, u1, u2))),
        add_symmetric(bb, symmetric_outer_sum((b0, b1, b2), (u0, u1, u2))),
    )
    q0, q1, q2 = scale(-r0, q0), scale(-r1, q1), scale(-r2, q2)
    u0, u1, u2 = scale(-r0, u0), scale(-r1, u1), scale(-r2, u2)
    constant = 0.0 * e0
    hessian = (
        h[0], h[1], h[2], h[3], h[4], h[5], q0[0], q1[0], q2[0],
        h[6], h[7], h[8], h[9], h[10], q0[1], q1[1], q2[1],
        h[11], h[12], h[13], h[14], q0[2], q1[2], q2[2],
        h[15], h[16], h[17], u0[0], u1[0], u2[0],
        h[18], h[19], u0[1], u1[1], u2[1],
        h[20], u0[2], u1[2], u2[2],
        p00 + constant, r0 * r1 * p01 + constant, r0 * r2 * p02 + constant,
        p11 + constant, r1 * r2 * p12 + constant,
        p22 + constant,
    )  # fmt: skip
    gradient = (ga[0], ga[1], ga[2], gb[0], gb[1], gb[2], r0 * m0, r1 * m1, r2 * m2)
    return 0.5 * (m0 * e0 + m1 * e1 + m2 * e2), gradient, hessian


_NATURAL = ("alpha_0", "alpha_1", "alpha_2")
_STIFFNESS = ("M00", "M01", "M02", "M11", "M12", "M22")
_SIGNS = ("sign_0", "sign_1", "sign_2")
MIDEDGE = Kernel(
    midedge,
    dimension=3,
    nodes=3,
    vectors=((0, 1), (0, 2)),
    angles=3,
    auxiliaries=21,
    naturals=_NATURAL,
    constants=_STIFFNESS + _SIGNS,
    scales=(("M00", "M01", "M02"), ("M01", "M11", "M12"), ("M02", "M12", "M22")),
)


def edge_angles(
    nodes: FloatArray, triangles: IntArray, face_edges: IntArray, normals: FloatArray
) -> FloatArray:
    """Angles [rad], shape (3, T), from the face normal to given normals of its edges.

    Args:
        nodes: Positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        face_edges: Edge opposite each corner, shape (T, 3).
        normals: Unit normal of each edge, across it, shape (3, B).
    """
    x = [nodes[triangles[:, k]].T for k in range(3)]
    a, b = x[1] - x[0], x[2] - x[0]
    n = cross(a, b)
    n = n / norm(n)
    angles = []
    for k, v in enumerate((b - a, -b, a)):
        length = norm(v)
        angles.append(-transported_angle(v, n, length, v / length, normals[:, face_edges[:, k]])[0])
    return np.stack(angles)


def midedge_term(
    name: str,
    dofs: DofMap,
    nodes: FloatArray,
    triangles: IntArray,
    face_edges: IntArray,
    face_signs: IntArray,
    frames: ShellFrames,
    *,
    youngs_modulus: Numbers,
    poisson_ratio: float,
    thickness: Numbers,
) -> StencilEnergy:
    """Build the bending energy of a shell by free mid-edge normals, stress-free in the rest shape.

    Args:
        name: Unique name.
        dofs: Numbering; carries one xi for each shell edge.
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        face_edges: Shell edge opposite each corner, shape (T, 3).
        face_signs: +1 where the triangle runs along its edge, -1 against it, shape (T, 3).
        frames: Kinematics of the mid-edge normals: gives the rest normals and the places of the
            auxiliary inputs.
        youngs_modulus: E [Pa].
        poisson_ratio: nu [1].
        thickness: h [m].

    Returns:
        Energy with one stencil per triangle; its natural strains (3, T) are the edge angles [rad]:
        see ``sections.shells.angles_of_curvature``.
    """
    count = len(triangles)
    signs = face_signs.T.astype(np.float64)
    natural = edge_angles(nodes, triangles, face_edges, frames.mean_normals(nodes.reshape(-1)))
    stiffness = bending_stiffness(nodes, triangles, youngs_modulus, poisson_ratio, thickness)
    return StencilEnergy.of(
        name,
        MIDEDGE,
        np.concatenate((dofs.of_nodes(triangles).reshape(count, -1), frames.angles[face_edges]), axis=1),
        {
            **dict(zip(_NATURAL, natural, strict=True)),
            **dict(zip(_STIFFNESS, stiffness, strict=True)),
            **dict(zip(_SIGNS, signs, strict=True)),
        },
        frames.edge_places(face_edges).reshape(count, -1),
    )
