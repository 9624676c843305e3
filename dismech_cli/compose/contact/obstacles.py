"""Obstacles of the scenario as rigid bodies."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...contact.cores import BoxCore, LineCore, PointCore, SegmentCore
from ...contact.obstacle import HalfSpace, Obstacle, Rounded, Shape
from ...contact.pose import Frame, Pose, rotation
from ...laws.laws import Constant
from ...scenario.language import obstacle as language
from ..laws import components
from ..scene import Scene

_ZERO = Constant(0.0)


def make_obstacle(scene: Scene, one: language.Obstacle) -> Obstacle:
    """Put an obstacle in its place, with its laws of time."""
    shape, place = _shape(one)
    motion = one.motion or language.ObstacleMotion()
    moved = (_ZERO, _ZERO, _ZERO)
    if motion.displacement is not None:
        moved = components(motion.displacement, scene.laws)  # type: ignore[assignment]
    angle = _ZERO if motion.angle is None else scene.laws(motion.angle)
    pose = Pose(place, moved, _unit(motion.axis), np.array(motion.about), angle)
    return Obstacle(one.name, shape, pose)


def _shape(one: language.Obstacle) -> tuple[Shape, Frame]:
    space = Frame(np.zeros((3, 1)), np.eye(3))
    match one:
        case language.PlaneObstacle():
            return HalfSpace(np.array(one.point), _unit(one.normal)), space
        case language.SphereObstacle():
            return Rounded(PointCore(np.array(one.center)), one.radius), space
        case language.CylinderObstacle():
            return Rounded(LineCore(np.array(one.point), _unit(one.axis)), one.radius), space
        case language.CapsuleObstacle():
            return Rounded(SegmentCore(np.array(one.start), np.array(one.end)), one.radius), space
        case language.BoxObstacle():
            core = BoxCore(0.5 * np.array(one.size) - one.edge_radius)
            place = Frame(np.array(one.center)[:, None], rotation(_unit(one.axis), one.angle))
            return Rounded(core, one.edge_radius), place


def _unit(direction: tuple[float, ...]) -> FloatArray:
    vector = np.array(direction)
    unit: FloatArray = vector / np.linalg.norm(vector)
    return unit
