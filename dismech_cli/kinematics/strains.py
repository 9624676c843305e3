"""Measured strains of rods and shells, for rest shapes, results and controllers."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..geometry.curvature import curvature_slopes, edge_pair, joint_directors
from ..geometry.frame_turn import turn_from_rest
from ..geometry.vectors import cross, dot, norm, scale
from ..mesh.measure import side_vectors, triangle_areas


def curvature_binormal(positions: FloatArray, nodes: IntArray) -> FloatArray:
    """Integrated curvature binormal 2 t_e x t_f / (1 + t_e.t_f) of each joint, shape (J, 3).

    Args:
        positions: Space positions [m], shape (N, 3).
        nodes: Node triples of the joints, shape (J, 3).
    """
    e, f = _edge_vectors(positions, nodes)
    kb: FloatArray = edge_pair(e, f)[5].T
    return kb


def joint_angles(positions: FloatArray, nodes: IntArray) -> FloatArray:
    """Angle [rad] by which each joint turns, up to pi where it folds back, shape (J,).

    Args:
        positions: Space positions [m], shape (N, 3).
        nodes: Node triples of the joints, shape (J, 3).
    """
    e, f = _edge_vectors(positions, nodes)
    angle: FloatArray = np.arctan2(norm(cross(e, f)), dot(e, f))
    return angle


def material_curvatures(
    binormal: FloatArray,
    auxiliary: FloatArray,
    indices: IntArray,
    signs: FloatArray,
    twist: FloatArray,
    rest_twist: FloatArray,
) -> FloatArray:
    """Integrated material curvatures kappa_1, kappa_2 of each joint, shape (2, J).

    Args:
        binormal: Integrated curvature binormals, shape (J, 3).
        auxiliary: Auxiliary array of the trial frames.
        indices: Places of m1e, m2e, m1f, m2f in it, shape (J, 12).
        signs: Walking directions, shape (J, 2).
        twist: Twist of the directors of f against those of e [rad], shape (J,).
        rest_twist: The same at rest, shape (J,).
    """
    a = auxiliary[indices.T]
    d1, d2, _, _ = joint_directors(
        a[0:3],
        scale(signs[:, 0], a[3:6]),
        a[6:9],
        scale(signs[:, 1], a[9:12]),
        0.5 * (twist - rest_twist),
        np.cos(rest_twist),
        np.sin(rest_twist),
    )
    slopes = curvature_slopes(binormal.T, d1, d2)
    return np.stack((-2.0 * slopes[1], 2.0 * slopes[0]))


def joint_frames(
    positions: FloatArray, nodes: IntArray, auxiliary: FloatArray, indices: IntArray, signs: FloatArray
) -> FloatArray:
    """Frames (t, m1, m2) of both edges of each joint as walked: edge, axis, component, shape (2, 3, 3, J).

    Args:
        positions: Space positions [m], shape (N, 3).
        nodes: Node triples, shape (J, 3).
        auxiliary: Auxiliary array of the trial frames.
        indices: Places of m1e, m2e, m1f, m2f in it, shape (J, 12).
        signs: Walking directions, shape (J, 2).
    """
    m = auxiliary[indices.T].reshape(2, 2, 3, -1)
    tangents = (scale(1.0 / norm(edge), edge) for edge in _edge_vectors(positions, nodes))
    return np.stack([np.stack((t, m[k, 0], signs[:, k] * m[k, 1])) for k, t in enumerate(tangents)])


def corner_turns(frames: FloatArray, cosines: FloatArray) -> FloatArray:
    """Turn from rest of each corner by components along its first frame, shape (3, J).

    Args:
        frames: Of both edges, shape (2, 3, 3, J).
        cosines: Between the axes of both at rest, by rows, shape (9, J).
    """
    (d0, d1, d2), (f0, f1, f2) = frames
    w = turn_from_rest(d0, d1, d2, f0, f1, f2, cosines)
    return np.stack([dot(w, axis) for axis in (d0, d1, d2)])


def planar_angles(positions: FloatArray, nodes: IntArray) -> FloatArray:
    """Angle [rad] between both edges of each joint, shape (J,), from planar positions (N, 2)."""
    e = positions[nodes[:, 1]] - positions[nodes[:, 0]]
    f = positions[nodes[:, 2]] - positions[nodes[:, 1]]
    angle: FloatArray = np.arctan2(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0], (e * f).sum(axis=1))
    return angle


def planar_turns(positions: FloatArray, nodes: IntArray, rest: FloatArray) -> FloatArray:
    """Turn 2 tan(phi/2) of each joint from its angle at rest [rad], shape (J,), positions (N, 2)."""
    turns: FloatArray = 2.0 * np.tan(0.5 * (planar_angles(positions, nodes) - rest))
    return turns


def planar_curvature(positions: FloatArray, nodes: IntArray) -> FloatArray:
    """Integrated curvature of each joint in the plane, shape (J,), from planar positions (N, 2)."""
    e = positions[nodes[:, 1]] - positions[nodes[:, 0]]
    f = positions[nodes[:, 2]] - positions[nodes[:, 1]]
    sine = e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    cosine = (e * f).sum(axis=1)
    size = np.sqrt((e * e).sum(axis=1) * (f * f).sum(axis=1))
    out: FloatArray = 2.0 * sine / (size + cosine)
    return out


def rest_metric(nodes: FloatArray, triangles: IntArray) -> FloatArray:
    """Metric (a.a, b.b, a.b) of a = x1 - x0, b = x2 - x0 [m^2], shape (3, T)."""
    a = (nodes[triangles[:, 1]] - nodes[triangles[:, 0]]).T
    b = (nodes[triangles[:, 2]] - nodes[triangles[:, 0]]).T
    # in the order of sums of the kernels: the rest shape is then stress-free to the last bit
    return np.stack([dot(a, a), dot(b, b), dot(a, b)])


def angles_of_curvature(nodes: FloatArray, triangles: IntArray, curvature: FloatArray) -> FloatArray:
    """Edge angles [rad], shape (3, T), of triangles whose shape operator is ``curvature``.

    Args:
        nodes: Rest positions [m], shape (N, 3).
        triangles: Shape (T, 3).
        curvature: Symmetric tensors [1/m], shape (T, 3, 3); positive where normals diverge (a
            sphere with outward normals). Their parts across the triangle do not count.
    """
    sides = side_vectors(nodes, triangles)
    along = np.einsum("kti,tij,ktj->kt", sides, curvature, sides)
    length = np.linalg.norm(sides, axis=2)
    angles: FloatArray = length * (along.sum(axis=0) - 2.0 * along) / (8.0 * triangle_areas(nodes, triangles))
    return angles


def _edge_vectors(positions: FloatArray, nodes: IntArray) -> tuple[FloatArray, FloatArray]:
    e = positions[nodes[:, 1]] - positions[nodes[:, 0]]
    f = positions[nodes[:, 2]] - positions[nodes[:, 1]]
    return e.T, f.T
