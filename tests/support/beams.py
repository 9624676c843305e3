"""Frames of straight beams by the stiffness of one beam each: exact for small loads at their joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dismech_cli.arrays import FloatArray

GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


@dataclass(frozen=True)
class Beam:
    """A beam between two joints, without shear.

    Attributes:
        ends: Its joints.
        director: m1 at any angle but along it; its part across counts.
        bending: EI1 and EI2 [N m^2]: about m2, then about m1.
        torsion: GJ [N m^2].
        axial: EA [N].
    """

    ends: tuple[int, int]
    director: Sequence[float]
    bending: tuple[float, float] = (1.0, 1.0)
    torsion: float = 0.8
    axial: float = 1e5


def _cross(v: FloatArray) -> FloatArray:
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def stiffness_of(beam: Beam, span: FloatArray) -> FloatArray:
    """Of displacement and rotation of both ends, shape (12, 12)."""
    length = float(np.linalg.norm(span))
    t = span / length
    m1 = np.asarray(beam.director, dtype=float) - t * (t @ np.asarray(beam.director, dtype=float))
    m1 /= np.linalg.norm(m1)
    m2 = np.cross(t, m1)
    turning = np.outer(t, t) / beam.torsion + np.outer(m2, m2) / beam.bending[0]
    turning += np.outer(m1, m1) / beam.bending[1]
    flexible = np.zeros((6, 6))
    flexible[:3, :3] = length / beam.axial * np.outer(t, t)
    for s in GAUSS:
        arm = _cross((1.0 - s) * span)
        # the moment at s of a force and a moment at the end
        moment = np.hstack((arm, np.eye(3)))
        flexible += 0.5 * length * moment.T @ turning @ moment
    follow = np.hstack((-np.eye(3), _cross(span), np.eye(3), np.zeros((3, 3))))
    turn = np.hstack((np.zeros((3, 3)), -np.eye(3), np.zeros((3, 3)), np.eye(3)))
    strains = np.vstack((follow, turn))
    return strains.T @ np.linalg.inv(flexible) @ strains


def frame_displacements(
    joints: FloatArray, beams: Sequence[Beam], clamped: Sequence[int], loads: Mapping[int, FloatArray]
) -> FloatArray:
    """Displacement and rotation of all joints under forces on some, shape (joints, 6)."""
    n = len(joints)
    matrix, force = np.zeros((6 * n, 6 * n)), np.zeros(6 * n)
    for beam in beams:
        a, b = beam.ends
        at = np.r_[6 * a : 6 * a + 6, 6 * b : 6 * b + 6]
        matrix[np.ix_(at, at)] += stiffness_of(beam, joints[b] - joints[a])
    for node, load in loads.items():
        force[6 * node : 6 * node + 3] = load
    free = np.setdiff1d(np.arange(6 * n), [6 * c + k for c in clamped for k in range(6)])
    out = np.zeros(6 * n)
    out[free] = np.linalg.solve(matrix[np.ix_(free, free)], force[free])
    return out.reshape(n, 6)
