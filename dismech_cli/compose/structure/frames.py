"""Frames of rod edges, and the material directors that they start from."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...kernels.driver import Driver
from ...kinematics.directors import space_parallel
from ...kinematics.dofs import DofMap
from ...kinematics.rod_frames import RodFrames
from ..scene import Scene
from .skeleton import Skeleton


def given_directors(scene: Scene, skeleton: Skeleton) -> FloatArray:
    """First material directors that the user gives, NaN elsewhere, shape (3, E).

    Raises:
        ScenarioError: One lies along its rod.
    """
    geometry, tangents = scene.geometry, _tangents(skeleton)
    given = np.full((3, len(geometry.edges)), np.nan)
    for rod, key in zip(geometry.rods, geometry.rod_keys, strict=True):
        if rod.director is not None:
            first = geometry.rod_edges[rod.name][0]
            across = np.linalg.norm(np.cross(tangents[:, first], rod.director))
            if across < 1e-6 * np.linalg.norm(rod.director):
                raise scene.error(
                    ("geometry", key, "director"),
                    "lies along the first edge of the rod; expected a direction across it",
                )
            given[:, first] = rod.director
    return given


def rest_directors(skeleton: Skeleton, given: FloatArray) -> FloatArray:
    """First material directors of the geometry's edges at rest, shape (3, E), from those given."""
    return space_parallel(_tangents(skeleton)[:, : given.shape[1]], given)


def rod_frames(skeleton: Skeleton, dofs: DofMap, driver: Driver, directors: FloatArray) -> RodFrames:
    """Frames of all edges: a wall has the director of its rod."""
    return RodFrames(
        np.ascontiguousarray(dofs.of_nodes(skeleton.edges[:, 0]).T),
        np.ascontiguousarray(dofs.of_nodes(skeleton.edges[:, 1]).T),
        dofs.of_angles(np.arange(len(skeleton.edges))),
        skeleton.joints.pairs,
        skeleton.joints.signs,
        np.concatenate((directors, directors[:, skeleton.owners]), axis=1),
        driver,
    )


def _tangents(skeleton: Skeleton) -> FloatArray:
    e = skeleton.positions[skeleton.edges[:, 1]] - skeleton.positions[skeleton.edges[:, 0]]
    return np.ascontiguousarray((e / skeleton.rest_lengths[:, None]).T)
