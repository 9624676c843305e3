"""Joints between rods: natural strains act there over half an edge of either rod, each with its own axes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ..scene import Scene
from ..structure.joints import Joints
from .joints import natural_density


@frozen
class Halves:
    """Some joints of an energy, and what natural strains of their rods do to it.

    Attributes:
        joints: Where they are.
        stencils: Their stencils, shape (J,).
        responses: For each natural strain of a rod by its name, the kernel's per unit density on either
            edge [m], shape (2, naturals, J).
    """

    joints: Joints
    stencils: IntArray
    responses: Mapping[str, FloatArray]

    def natural(self, scene: Scene) -> FloatArray:
        """Natural strain from what the user gives the rods on both sides, shape (naturals, J).

        Raises:
            ScenarioError: A list of natural strains does not fit.
        """
        out: FloatArray = np.zeros(next(iter(self.responses.values())).shape[1:])
        for index in range(len(scene.geometry.rods)):
            for name, response in self.responses.items():
                density = natural_density(scene, self.joints, index, name)
                if density is None:
                    continue
                for side in range(2):
                    mine = self.joints.rods[:, side] == index
                    out[:, mine] += response[side][:, mine] * density[self.joints.numbers[mine, side]]
        return out


def halves_in_space(joints: Joints, stencils: IntArray, cosines: FloatArray) -> Halves:
    """What a unit density on the halves of either edge turns, along the frame (t, m1, m2) of the first.

    Walked backwards, a rod twists alike and bends alike about its second director, which turns round
    with it, while its first one stays and sees the other side.

    Args:
        joints: The joints.
        stencils: Their stencils, shape (J,).
        cosines: Between the axes of both edges at rest, as walked, shape (J, 3, 3).
    """
    axes = {name: np.zeros((*joints.pairs.shape, 3)) for name in ("twist", "curvature_1", "curvature_2")}
    axes["twist"][..., 0] = axes["curvature_1"][..., 2] = 1.0
    axes["curvature_2"][..., 1] = -joints.signs
    responses = {}
    for name, axis in axes.items():
        along = axis * joints.halves[..., None]
        responses[name] = np.stack((along[:, 0].T, np.einsum("Jij,Jj->iJ", cosines, along[:, 1])))
    return Halves(joints, stencils, responses)


def halves_in_plane(joints: Joints, stencils: IntArray, inside: IntArray) -> Halves:
    """What a unit density on the halves of either edge turns in the plane.

    Args:
        joints: The joints.
        stencils: Their stencils, shape (J,).
        inside: The curvature of each rod in the plane, and its sign, shape (rods, 2).
    """
    responses = {}
    for component, name in enumerate(("curvature_1", "curvature_2")):
        sign = np.where(inside[:, 0] == component, inside[:, 1], 0)[joints.rods]
        responses[name] = (sign * joints.signs * joints.halves).T[:, None]
    return Halves(joints, stencils, responses)
