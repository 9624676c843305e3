"""Which joints are corners: two edges that meet at an angle, not a curve cut into edges.

The curvature of a joint stands for a smooth curve, and its stiffness grows with its angle. At a corner
two straight beams meet instead, stiffly joined; there the angle from rest counts.
"""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray
from ...kinematics.strains import joint_angles
from .joints import Joints

# Two rods that meet straighter than this go on as one [rad]; mesh files carry 1e-10.
_STRAIGHT = 1e-6
# A kink turns by more than any curve should within one edge [rad],
_KINK = np.radians(20.0)
# and by this many times what the joints beside it do.
_STANDS_OUT = 2.0


def sharp_joints(positions: FloatArray, joints: Joints) -> BoolArray:
    """Mask of the corners, shape (J,): joints of two edges alone, none of it released.

    Args:
        positions: Rest positions, walls included [m], shape (N + W, 3).
        joints: All joints.
    """
    angle = joint_angles(positions, joints.triples)
    # each joint as either of its edges sees it: that edge's end at the node, and its other end
    centre, far = joints.triples[:, [1, 1]], joints.triples[:, [0, 2]]
    here, there = (joints.pairs * len(positions) + node for node in (centre, far))
    ends, place, count = np.unique(here, return_inverse=True, return_counts=True)
    alone = (count[place.reshape(here.shape)] == 1).all(axis=1)
    largest = np.zeros(len(ends))
    np.maximum.at(largest, place.reshape(-1), np.repeat(angle, 2))
    at = np.minimum(np.searchsorted(ends, there), max(len(ends) - 1, 0))
    beside = np.where(ends[at] == there, largest[at], 0.0).max(axis=1) if len(ends) else angle
    between = joints.rod < 0
    kinked = ~between & (angle > _KINK) & (angle > _STANDS_OUT * beside)
    sharp: BoolArray = alone & ((between & (angle > _STRAIGHT)) | kinked) & ~joints.loose.any(axis=1)
    return sharp
