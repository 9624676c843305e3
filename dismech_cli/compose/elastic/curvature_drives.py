"""Actuation of the curvature of shells as drives of natural angles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.strains import angles_of_curvature
from ...model.driven import Drive
from ...scenario.language.actuation import SurfaceCurvatureActuation
from ...scenario.text.tree import KeyPath
from ...scenario.values.selection import Selection
from ..scene import Scene
from ..shells.bending import bending_of
from ..shells.body import ShellBody
from .following import Ports, following

# A direction this close to the normal, by its sine, lies in no triangle.
_UPRIGHT = 1e-6


def curvature_drives(
    scene: Scene, body: ShellBody, index: int, actuation: SurfaceCurvatureActuation, ports: Ports
) -> Iterator[Drive]:
    """Drives of the natural angles at the sides of triangles: linear in the curvature.

    Raises:
        ScenarioError: The shell knows no curvature, no triangle is driven, or ``along`` stands on one.
    """
    nodes = scene.geometry.nodes
    chosen = chosen_triangles(scene, body, ("actuation", index), actuation)
    driven = body.triangles[chosen.stencils]
    x, y, z = nodes[driven].mean(axis=1).T
    at = {"x": x, "y": y, "z": z, "r": np.hypot(x, y)}
    members = np.arange(len(driven))
    for direction, value in ((chosen.along, actuation.value), (chosen.across, actuation.across)):
        if value == 0.0:
            continue
        angles = chosen.angles(nodes, body.triangles, direction, direction)
        signal = following(scene, ports, index, value)(members, at)
        for row, factors in enumerate(angles):
            yield Drive(row, chosen.stencils, signal, np.zeros(len(driven)), factors)


class ChoosesTriangles(Protocol):
    """What acts on some triangles of a shell along a direction: an actuation or a sensor."""

    @property
    def where(self) -> Selection | None:
        """Nodes that hold all corners of a triangle, or None for all."""

    @property
    def along(self) -> tuple[float, ...]:
        """The direction."""


@frozen
class Chosen:
    """Triangles of a shell and directions in them.

    Attributes:
        stencils: Their numbers in the shell, shape (K,).
        along: Unit vectors, shape (K, 3).
        across: Across them in the triangle.
        factor: Of the angles of the bending model per angle between normals.
    """

    stencils: IntArray
    along: FloatArray
    across: FloatArray
    factor: float

    def angles(self, nodes: FloatArray, triangles: IntArray, one: FloatArray, two: FloatArray) -> FloatArray:
        """Natural angles of a unit curvature along the sum of ``one two^T`` and its transpose, by half."""
        tensor = one[:, :, None] * two[:, None, :]
        if one is not two:
            tensor = 0.5 * (tensor + tensor.transpose(0, 2, 1))
        # the shape operator is positive where normals diverge: on the other side
        out: FloatArray = -self.factor * angles_of_curvature(nodes, triangles[self.stencils], tensor)
        return out


def chosen_triangles(scene: Scene, body: ShellBody, path: KeyPath, spec: ChoosesTriangles) -> Chosen:
    """Triangles of a shell that an actuation or a sensor acts on.

    Raises:
        ScenarioError: The shell knows no curvature, there is no triangle, or ``along`` stands on one.
    """
    shell, nodes = body.shell, scene.geometry.nodes
    factor = bending_of(shell).curvature_factor
    if factor is None:
        raise scene.error(
            (*path, "shell"),
            f"bending '{shell.bending}' of '{shell.name}' knows no curvature; take 'dihedral', or bending: "
            "midedge",
        )
    stencils = np.arange(len(body.triangles))
    if spec.where is not None:
        inside = np.isin(body.triangles, scene.places.nodes((*path, "where")))
        stencils = np.flatnonzero(inside.all(axis=1))
        if stencils.size == 0:
            raise scene.error((*path, "where"), f"holds no whole triangle of shell '{shell.name}'")
    along, across = _directions(nodes[body.triangles[stencils]], np.array(spec.along))
    if not np.isfinite(along).all():
        raise scene.error((*path, "along"), f"stands normal to a triangle of shell '{shell.name}'")
    return Chosen(stencils, along, across, factor)


def _directions(corners: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit vectors in each triangle (T, 3): along the one wanted, NaN where it stands on it; across."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    flat = wanted - (normal @ wanted)[:, None] * normal
    size = np.linalg.norm(flat, axis=1)
    along = flat / np.where(size > _UPRIGHT * np.linalg.norm(wanted), size, np.nan)[:, None]
    return along, np.cross(normal, along)
