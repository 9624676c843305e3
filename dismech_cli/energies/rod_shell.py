"""A rod clamped to a face of a shell: E = sum K_i (b_i - n_i)^2 / 2, b = (w_0, s w_1, s w_2).

The face carries a copy (g0, g1, g2) of the frame (t, m1, m2) that the rod has at rest; w is the
rotation vector 2 tan(phi/2) n from the rod's frame to that copy (Cayley's, twice Rodrigues'
parameters), by components along the rod's frame. If the face is twisted about the rod by tau and then
bent by phi, w_0 = 2 tan(tau/2), and s = cos(tau/2) makes the rest 2 tan(phi/2), the discrete
curvature of rods, whatever the twist: a joint may release either. The natural n is that of half an
edge.

The face turns with its normal and, about it, with the rotation of the polar decomposition of its
deformation: stretching a sheet does not turn the rods on it. The tangent of the rod points to the
shell; a sign of -1 says that its edge runs the other way: then m1 stays, m2 and theta change sign.
As in all energies of rods the second derivatives are those along paths on which the frame is
parallel-transported, which are exact where frames are stored (Bergou et al. 2010).

Parameters per stencil: n_0, n_1, n_2 [1]; K_0, K_1, K_2 [N m]; alpha, beta_u, beta_v [1/m], which
write the unit vector along u at rest as alpha u and the one across it in the face as
beta_u u + beta_v v; the components of the rod's rest frame (t, m1, m2) along, across and normal to the
face [1]; the sign. Auxiliary inputs: m1, m2 of the rod's edge.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.blocks import add_block, add_symmetric, outer_sum, pack_three_and_angle
from ..geometry.face_rotation import face_axes, face_frame, face_turning
from ..geometry.frame_turn import transposed_turn, turn
from ..geometry.kernel import kernel
from ..geometry.vectors import Vector, add, combine, cross, dot, norm, outer, scale, self_outer, sym_outer
from ..kernels.shape import Kernel
from ..kinematics.dofs import DofMap
from ..model.stencil import StencilEnergy


@kernel
def slopes(
    t: Vector, d0: Vector, il: Any, s: Any, n: Vector, iu: Vector, iv: Vector, pu: Vector, pv: Vector
) -> Any:
    """Slopes, with respect to (e, u, v, theta), of t . (spin of the face - spin of the rod).

    The rod spins by d0 x de / l + s dtheta d0, the face by -(n.du) v/A + (n.dv) u/A + n (pu.du + pv.dv).
    """
    turned = dot(n, t)
    return (
        scale(il, cross(d0, t)),
        combine(-dot(iv, t), n, turned, pu),
        combine(dot(iu, t), n, turned, pv),
        -s * dot(d0, t),
    )


@kernel
def angle_column(angle: Any, vector: Any) -> Vector:
    """Column of the angle in the rows of a vector: b b^T + c c^T + a q^T + q a^T + w m^T + m w^T."""
    bt, ct, at, qt, wt, mt = angle
    b, c, a, q, w, m = vector
    return add(combine(bt, b, ct, c), add(combine(qt, a, at, q), combine(mt, w, wt, m)))


@kernel
def rod_on_face(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to (e, u, v, theta)."""
    e, u, v, s = y[0:3], y[3:6], y[6:9], p[18]
    alpha, beta_u, beta_v = p[6], p[7], p[8]
    il = 1.0 / norm(e)
    d0, d1, d2 = scale(il, e), a[0:3], scale(s, a[3:6])
    f, h, n, size, area, pu, pv = face_frame(u, v, alpha, beta_u, beta_v)
    g0 = combine(p[9], f, 1.0, combine(p[10], h, p[11], n))
    g1 = combine(p[12], f, 1.0, combine(p[13], h, p[14], n))
    g2 = combine(p[15], f, 1.0, combine(p[16], h, p[17], n))
    w = turn(d0, d1, d2, g0, g1, g2)
    w0, w1, w2 = dot(w, d0), dot(w, d1), dot(w, d2)
    # E(w) and its derivatives: twist enters bending through c
    k0, k1, k2 = p[3], p[4], p[5]
    c = 1.0 / (1.0 + 0.25 * w0 * w0)
    bent, dc = k1 * w1 * w1 + k2 * w2 * w2, -0.5 * c * c * w0
    # what the natural strains add, with the root of c and its derivatives
    n0, n1, n2 = k0 * p[0], k1 * p[1], k2 * p[2]
    root = c**0.5
    dr, ddr = -0.25 * root * c * w0, 0.25 * root * c * (0.75 * c * w0 * w0 - 1.0)
    grown = n1 * w1 + n2 * w2
    constant = 0.5 * (n0 * p[0] + n1 * p[1] + n2 * p[2])
    energy = 0.5 * (k0 * w0 * w0 + c * bent) - n0 * w0 - root * grown + constant
    x1, x2 = c * k1 * w1 - root * n1, c * k2 * w2 - root * n2
    stress = combine(k0 * w0 - n0 + 0.5 * dc * bent - dr * grown, d0, 1.0, combine(x1, d1, x2, d2))
    curved = k0 + 0.25 * c * c * (c * w0 * w0 - 1.0) * bent - ddr * grown
    # dE = m . (spin of the face - spin of the rod)
    m = transposed_turn(w, stress)
    iu, iv = scale(1.0 / area, u), scale(1.0 / area, v)
    me, mu, mv, mt = slopes(m, d0, il, s, n, iu, iv, pu, pv)

    # second derivatives along the relative spin: E''_ij t_i t_j^T + (w m^T + m w^T)/4
    t0, t1, t2 = transposed_turn(w, d0), transposed_turn(w, d1), transposed_turn(w, d2)
    mixed = combine(0.5 * curved, t0, 1.0, combine(dc * k1 * w1 - dr * n1, t1, dc * k2 * w2 - dr * n2, t2))
    we, wu, wv, wt = slopes(scale(0.25, w), d0, il, s, n, iu, iv, pu, pv)
    ae, au, av, at = slopes(t0, d0, il, s, n, iu, iv, pu, pv)
    qe, qu, qv, qt = slopes(mixed, d0, il, s, n, iu, iv, pu, pv)
    be, bu, bv, bt = slopes(scale((c * k1) ** 0.5, t1), d0, il, s, n, iu, iv, pu, pv)
    ce, cu, cv, ct = slopes(scale((c * k2) ** 0.5, t2), d0, il, s, n, iu, iv, pu, pv)

    # m . (spin of the face x spin of the rod), half of it in each of two transposed blocks
    along = 0.5 * il * dot(d0, m)
    d0xm = cross(d0, m)
    xn = combine(along, n, -0.5 * il * dot(d0, n), m)
    xu = combine(along, iu, -0.5 * il * dot(d0, iu), m)
    xv = combine(along, iv, -0.5 * il * dot(d0, iv), m)
    _, ru, rv, _ = slopes(scale(0.5 * s, d0xm), d0, il, s, n, iu, iv, pu, pv)
    # m . change of the rod's spin along a straight path of e
    rt = scale(-0.5 * s * il, combine(1.0, m, -dot(d0, m), d0))

    left_e, left_u = (be, ce, ae), (bu, cu, au)
    right_u, right_v = (bu, cu, qu), (bv, cv, qv)
    ee = add_symmetric(
        add_symmetric(self_outer(be), self_outer(ce)), add_symmetric(sym_outer(ae, qe), sym_outer(we, me))
    )
    ee = add_symmetric(ee, sym_outer(scale(-il * il, d0), d0xm))
    uu, uv, vv = face_turning(m, u, v, f, h, n, size, area, alpha, beta_u, beta_v, pu, pv)
    uu = add_symmetric(uu, add_symmetric(add_symmetric(self_outer(bu), self_outer(cu)), sym_outer(au, qu)))
    uu = add_symmetric(uu, sym_outer(wu, mu))
    vv = add_symmetric(vv, add_symmetric(add_symmetric(self_outer(bv), self_outer(cv)), sym_outer(av, qv)))
    vv = add_symmetric(vv, sym_outer(wv, mv))
    uv = add_block(uv, add_block(outer_sum(left_u, right_v), outer_sum((qu, wu, mu), (av, mv, wv))))
    # rows e, columns u and v: the transposed of n x_v^T and the like
    eu = add_block(outer_sum(left_e, right_u), outer_sum((qe, we, me), (au, mu, wu)))
    eu = add_block(eu, add_block(outer(xn, pu), outer(scale(-1.0, xv), n)))
    ev = add_block(outer_sum(left_e, right_v), outer_sum((qe, we, me), (av, mv, wv)))
    ev = add_block(ev, add_block(outer(xn, pv), outer(xu, n)))
    et = add(angle_column((bt, ct, at, qt, wt, mt), (be, ce, ae, qe, we, me)), rt)
    ut = add(angle_column((bt, ct, at, qt, wt, mt), (bu, cu, au, qu, wu, mu)), ru)
    vt = add(angle_column((bt, ct, at, qt, wt, mt), (bv, cv, av, qv, wv, mv)), rv)
    tt = bt * bt + ct * ct + 2.0 * (at * qt + wt * mt)
    gradient = (me[0], me[1], me[2], mu[0], mu[1], mu[2], mv[0], mv[1], mv[2], mt)
    return energy, gradient, pack_three_and_angle(ee, eu, ev, uu, uv, vv, et, ut, vt, tt)


@kernel
def rod_beside_face(y: Any, a: Any, p: Any) -> Any:
    """The same for a face that does not end at the joint: its stencil has a node more."""
    return rod_on_face(y, a, p)


_STIFFNESS = ("K_0", "K_1", "K_2")
_ACROSS = ("alpha", "beta_u", "beta_v")
_COSINES = tuple(f"{mine}_{rest}" for mine in ("t", "m1", "m2") for rest in ("along", "across", "normal"))
ROD_ON_FACE = Kernel(
    rod_on_face,
    dimension=3,
    nodes=4,
    vectors=((0, 1), (1, 2), (1, 3)),
    angles=1,
    auxiliaries=6,
    naturals=("n_0", "n_1", "n_2"),
    scales=(("K_0",), ("K_1",), ("K_2",)),
    constants=(*_STIFFNESS, *_ACROSS, *_COSINES, "sign"),
)
ROD_BESIDE_FACE = replace(ROD_ON_FACE, function=rod_beside_face, nodes=5, vectors=((0, 1), (2, 3), (2, 4)))


def rod_shell_terms(
    name: str,
    dofs: DofMap,
    positions: FloatArray,
    rods: IntArray,
    triangles: IntArray,
    angles: IntArray,
    signs: FloatArray,
    directors: FloatArray,
    stiffness: FloatArray,
    places: IntArray,
) -> tuple[tuple[StencilEnergy, IntArray], ...]:
    """Build the energy of rods clamped to faces, stress-free in the rest shape.

    Args:
        name: Unique name; the part whose faces do not end at their joint adds ``.beside``.
        dofs: Numbering.
        positions: Rest positions [m], shape (N, 3).
        rods: Far node of each rod's edge and its node at the joint, shape (S, 2).
        triangles: A face for each, without the far node, shape (S, 3).
        angles: DOF of the angle of each rod's edge, shape (S,).
        signs: +1 where the edge runs to the joint, -1 where it runs from it, shape (S,).
        directors: First and second director of the edge at rest, shape (2, S, 3).
        stiffness: K_0, K_1, K_2 [N m], shape (3, S).
        places: Auxiliary indices of both directors by component, shape (S, 6).

    Returns:
        Energies with one stencil per pair of a rod and a face, and which pairs these are; none without pairs.
    """
    ends = triangles == rods[:, 1:]
    # corners in turn, the one at the joint first
    first = np.argmax(ends, axis=1)[:, None]
    corners = np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)
    x = positions[corners]
    across, rest = face_axes(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    tangent = positions[rods[:, 1]] - positions[rods[:, 0]]
    tangent = tangent / np.linalg.norm(tangent, axis=1)[:, None]
    frame = np.stack((tangent, directors[0], signs[:, None] * directors[1]), axis=1)
    cosines = np.einsum("sic,sjc->ijs", frame, rest).reshape(9, -1)
    parameters = {
        **dict.fromkeys(ROD_ON_FACE.naturals, np.zeros(len(rods))),
        **dict(zip(_STIFFNESS, stiffness, strict=True)),
        **dict(zip(_ACROSS, across, strict=True)),
        **dict(zip(_COSINES, cosines, strict=True)),
        "sign": signs,
    }
    terms = []
    at_joint = ends.any(axis=1)
    for label, energy, mine, nodes in (
        (name, ROD_ON_FACE, at_joint, np.column_stack((rods[:, :1], corners))),
        (f"{name}.beside", ROD_BESIDE_FACE, ~at_joint, np.column_stack((rods, corners))),
    ):
        if mine.any():
            stencil = np.column_stack((dofs.of_nodes(nodes[mine]).reshape(mine.sum(), -1), angles[mine]))
            values = {key: value[mine] for key, value in parameters.items()}
            term = StencilEnergy.of(label, energy, stencil, values, places[mine])
            terms.append((term, np.flatnonzero(mine)))
    return tuple(terms)
