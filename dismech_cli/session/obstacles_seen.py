"""Obstacles of a scene as those who draw want them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..arrays import FloatArray
from ..compose.bodies.shell import shell_mesh
from ..compose.scene import make_scene
from ..render.settings import Solid, Triple
from ..scenario.language import obstacle as language
from ..scenario.load import LoadedScenario

_AXES = np.eye(3)
_ORIGIN = np.zeros(3)


def solids_of(loaded: LoadedScenario, times: FloatArray) -> tuple[Solid, ...]:
    """Obstacles at the times of frames [s]; none in a scene without them."""
    obstacles = loaded.scenario.obstacles
    if not obstacles:
        return ()
    # what no scene without obstacles loads
    from ..compose.contact.obstacles import make_obstacle

    scene = make_scene(loaded)
    found = []
    for index, one in enumerate(obstacles):
        pose = make_obstacle(scene, index).pose
        corners = _corners(one, loaded.directory)
        origin, axes, half, radius = _shape(one, corners)
        seen = times[:1] if pose.still else times
        frames = [pose.at(float(t)) for t in seen]
        found.append(
            Solid(
                half=half,
                radius=radius,
                times=seen,
                origins=np.array([frame.outward(origin[:, None])[:, 0] for frame in frames]),
                turns=np.array([frame.turn @ axes for frame in frames]),
                triangles=corners - origin,
            )
        )
    return tuple(found)


def _corners(one: language.Obstacle, directory: Path) -> FloatArray:
    """Corners of its triangles [m], shape (T, 3, 3); most have none."""
    if isinstance(one, language.MeshObstacle):
        mesh = shell_mesh(one, directory).mesh
        return mesh.nodes[mesh.triangles]
    return np.empty((0, 3, 3))


def _shape(one: language.Obstacle, corners: FloatArray) -> tuple[FloatArray, FloatArray, Triple, float]:
    """Middle, axes as columns, half sides and radius, where its pose is that of the start."""
    match one:
        case language.PlaneObstacle():
            return np.array(one.point), _upright(np.array(one.normal)), (np.inf, np.inf, 0.0), 0.0
        case language.SphereObstacle():
            return np.array(one.center), _AXES, (0.0, 0.0, 0.0), one.radius
        case language.CylinderObstacle():
            return np.array(one.point), _upright(np.array(one.axis)), (0.0, 0.0, np.inf), one.radius
        case language.CapsuleObstacle():
            start, end = np.array(one.start), np.array(one.end)
            half = 0.5 * float(np.linalg.norm(end - start))
            return 0.5 * (start + end), _upright(end - start), (0.0, 0.0, half), one.radius
        case language.BoxObstacle():
            x, y, z = (0.5 * side - one.edge_radius for side in one.size)
            return _ORIGIN, _AXES, (x, y, z), one.edge_radius
        case language.MeshObstacle():
            lowest, highest = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
            x, y, z = (0.5 * (highest - lowest)).tolist()
            return 0.5 * (lowest + highest), _AXES, (x, y, z), 0.5 * one.thickness


def _upright(direction: FloatArray) -> FloatArray:
    """Axes, as columns, of which the last has a direction."""
    z = direction / np.linalg.norm(direction)
    x = np.cross(_AXES[np.abs(z).argmin()], z)
    x /= np.linalg.norm(x)
    return np.stack((x, np.cross(z, x), z), axis=1)
