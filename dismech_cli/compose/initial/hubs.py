"""Frames of hubs in a displaced shape: half way between what the edges there say."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...geometry.rotation import orthonormal_to
from ...kinematics.rod_frames import RodFrames
from ...kinematics.strains import joint_frames
from ..structure.joints import Joints
from ..structure.structure import Structure


def settled(structure: Structure, q: FloatArray) -> FloatArray:
    """The shape with every stub where the edges at its hub carry it, on average by their stiffness.

    Each edge turns the frame of the hub with itself; stubs have no mass, and start near their balance. Those
    that a motion holds go the way of their node.

    Args:
        structure: What moves.
        q: A shape whose stubs may be anywhere, shape (n,).
    """
    skeleton, dofs = structure.skeleton, structure.dofs
    if not len(skeleton.hubs):
        return q
    at_hubs = skeleton.corners.some(skeleton.corners.pairs[:, 1] >= skeleton.stubs[0])
    carried = (_in_space if dofs.n_angles else _in_plane)(structure, at_hubs, q)
    hub = at_hubs.pairs[:, 1] - skeleton.stubs[0]
    of_hub = hub == np.arange(len(skeleton.hubs))[:, None]
    axes = np.einsum("acJ,HJ->acH", carried / at_hubs.voronoi, of_hub)
    tangent = axes[0] / np.linalg.norm(axes[0], axis=0)
    _, first = np.unique(hub, return_index=True)
    node, ghost = at_hubs.triples[first, 1], at_hubs.triples[first, 2]
    out = q.copy()
    reach = skeleton.rest_lengths[skeleton.stubs] * tangent
    out[dofs.of_nodes(ghost)] = out[dofs.of_nodes(node)] + reach.T
    if dofs.n_angles:
        angles = dofs.of_angles(skeleton.stubs)
        out[angles] = 0.0
        along = at_hubs.signs[first, 1] * tangent
        out[angles] = _angle(structure, out, along, np.stack(orthonormal_to(axes[1], tangent)))
    held = np.zeros(len(skeleton.hubs), dtype=np.bool_)
    for hold in structure.holds:
        held |= np.isin(skeleton.hubs, hold.hubs)
    still, own = dofs.of_nodes(ghost[held]), dofs.of_nodes(node[held])
    out[still] = q[own] + structure.rest[still] - structure.rest[own]
    if dofs.n_angles:
        out[angles[held]] = 0.0
    return out


def _in_space(structure: Structure, joints: Joints, q: FloatArray) -> FloatArray:
    """Axes (t, m1) of the stub as each edge carries it, shape (2, 3, J)."""
    frames = structure.rod_frames
    assert isinstance(frames, RodFrames)
    places = frames.director_places(joints.pairs).reshape(-1, 12)
    at_rest = frames.rest(structure.rest)
    (before, stub), (now, _) = (
        joint_frames(
            structure.dofs.space_positions(shape),
            joints.triples,
            frames.transport(at_rest, shape).auxiliary,
            places,
            joints.signs,
        )
        for shape in (structure.rest, q)
    )
    carried: FloatArray = np.einsum("icJ,idJ,adJ->acJ", now, before, stub[:2])
    return carried


def _in_plane(structure: Structure, joints: Joints, q: FloatArray) -> FloatArray:
    """Direction of the stub as each edge carries it, shape (1, 2, J)."""
    before, now = (_directions(structure, joints, shape) for shape in (structure.rest, q))
    carried = now[0] / before[0] * before[1]
    return np.stack((carried.real, carried.imag))[None]


def _directions(structure: Structure, joints: Joints, q: FloatArray) -> FloatArray:
    """Unit vectors along both edges as complex numbers, shape (2, J)."""
    x = structure.dofs.positions(q)[joints.triples]
    z = np.diff(x[..., 0] + 1j * x[..., 1], axis=1).T
    out: FloatArray = z / np.abs(z)
    return out


def _angle(structure: Structure, q: FloatArray, along: FloatArray, wanted: FloatArray) -> FloatArray:
    """Angles of the stubs that bring their first directors where they are wanted, each (3, H)."""
    frames, stubs = structure.rod_frames, structure.skeleton.stubs
    assert isinstance(frames, RodFrames)
    have = frames.transport(frames.rest(structure.rest), q).auxiliary[frames.director_places(stubs)[:, :3]].T
    across = np.cross(along.T, have.T).T
    angle: FloatArray = np.arctan2((across * wanted).sum(axis=0), (have * wanted).sum(axis=0))
    return angle
