"""Obstacles of the scenario as rigid bodies."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...contact.obstacles.obstacle import HalfSpace, Obstacle, Rounded, Shape
from ...contact.obstacles.pose import Frame, Pose, rotation
from ...contact.obstacles.rigid_surface import RigidSurface
from ...contact.pieces.cores import BoxCore, LineCore, PointCore, SegmentCore
from ...errors import MeshError
from ...laws.laws import Constant
from ...mesh.topology.sides import rim_sides
from ...scenario.language import obstacle as language
from ..bodies.shell import shell_mesh
from ..laws import components
from ..scene import Scene

_ZERO = Constant(0.0)


def make_obstacle(scene: Scene, index: int) -> Obstacle:
    """Put an obstacle in its place, with its laws of time.

    Raises:
        ScenarioError: Its mesh is unusable.
    """
    one = scene.scenario.obstacles[index]
    shape, place = _shape(scene, index, one)
    motion = one.motion or language.ObstacleMotion()
    moved = (_ZERO, _ZERO, _ZERO)
    if motion.displacement is not None:
        moved = components(motion.displacement, scene.laws)  # type: ignore[assignment]
    angle = _ZERO if motion.angle is None else scene.laws(motion.angle)
    pose = Pose(place, moved, _unit(motion.axis), np.array(motion.about), angle)
    return Obstacle(one.name, shape, pose)


def _shape(scene: Scene, index: int, one: language.Obstacle) -> tuple[Shape, Frame]:
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
        case language.MeshObstacle():
            return _surface(scene, index, one), space


def _surface(scene: Scene, index: int, one: language.MeshObstacle) -> RigidSurface:
    path = ("obstacles", index, "generate" if one.generate is not None else "mesh")
    try:
        mesh = shell_mesh(one, scene.loaded.directory).mesh
    except MeshError as error:
        raise scene.error(path, str(error)) from error
    rim = rim_sides(mesh.triangles)
    if one.solid and len(rim):
        raise scene.error(
            ("obstacles", index, "solid"), f"the surface is not closed: {len(rim)} of its edges are rims"
        )
    return RigidSurface.of(mesh.nodes, mesh.triangles, 0.5 * one.thickness)


def _unit(direction: tuple[float, ...]) -> FloatArray:
    vector = np.array(direction)
    unit: FloatArray = vector / np.linalg.norm(vector)
    return unit
