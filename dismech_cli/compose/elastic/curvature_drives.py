"""Actuation of the curvature of shells as drives of natural angles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import FloatArray
from ...kinematics.strains import angles_of_curvature
from ...model.driven import Drive
from ...scenario.language.actuation import SurfaceCurvatureActuation
from ..scene import Scene
from ..shells.bending import bending_of
from ..shells.body import ShellBody

# A direction this close to the normal, by its sine, lies in no triangle.
_UPRIGHT = 1e-6


def curvature_drives(
    scene: Scene, body: ShellBody, index: int, actuation: SurfaceCurvatureActuation
) -> Iterator[Drive]:
    """Drives of the natural angles at the sides of triangles: linear in the curvature.

    Raises:
        ScenarioError: The shell knows no curvature, no triangle is driven, or ``along`` stands on one.
    """
    path, shell, nodes = ("actuation", index), body.shell, scene.geometry.nodes
    factor = bending_of(shell).curvature_factor
    if factor is None:
        raise scene.error(
            (*path, "shell"),
            f"bending '{shell.bending}' of '{shell.name}' knows no curvature; take 'dihedral', or bending: "
            "midedge",
        )
    triangles = body.triangles
    stencils = np.arange(len(triangles))
    if actuation.where is not None:
        inside = np.isin(triangles, scene.places.nodes((*path, "where")))
        stencils = np.flatnonzero(inside.all(axis=1))
        if stencils.size == 0:
            raise scene.error((*path, "where"), f"holds no whole triangle of shell '{shell.name}'")
    driven = triangles[stencils]
    along, across = _directions(nodes[driven], np.array(actuation.along))
    if not np.isfinite(along).all():
        raise scene.error((*path, "along"), f"stands normal to a triangle of shell '{shell.name}'")
    x, y, z = nodes[driven].mean(axis=1).T
    at = {"x": x, "y": y, "z": z, "r": np.hypot(x, y)}
    for direction, value in ((along, actuation.value), (across, actuation.across)):
        if value == 0.0:
            continue
        tensor = direction[:, :, None] * direction[:, None, :]
        # the shape operator is positive where normals diverge: on the other side
        angles = -factor * angles_of_curvature(nodes, driven, tensor)
        for row, factors in enumerate(angles):
            yield Drive(row, stencils, scene.laws(value, at), np.zeros(len(stencils)), factors)


def _directions(corners: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit vectors in each triangle (T, 3): along the one wanted, NaN where it stands on it; across."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    flat = wanted - (normal @ wanted)[:, None] * normal
    size = np.linalg.norm(flat, axis=1)
    along = flat / np.where(size > _UPRIGHT * np.linalg.norm(wanted), size, np.nan)[:, None]
    return along, np.cross(normal, along)
