"""Joints of two rod edges at an angle: half an edge of either rod in series, each with its own axes.

At hubs the second edge is the stub, which bends nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from ...arrays import IntArray
from ...energies.bend_planar import CORNER_PLANAR
from ...energies.rigid_joint import COSINES, RIGID_JOINT, STIFFNESS
from ...frozen import frozen
from ...kinematics.rod_frames import RodFrames
from ...kinematics.strains import joint_frames, planar_angles
from ...model.stencil import StencilEnergy
from ...run.observables.corners import CornerStrains, FramedCorners, PlanarCorners
from ..scene import Scene
from ..structure.plan import Bending
from ..structure.structure import Structure
from .halves import Halves, halves_in_plane, halves_in_space
from .joints import node_dofs, of_edges

_NAME = "corners"


@frozen
class Corners:
    """The energy of all corners, and what natural strains of their rods do to it.

    Attributes:
        energy: Stress-free at rest but for the natural strains, which add to the angle.
        halves: Where they are, and what natural strains do.
        strains: What fields report.
    """

    energy: StencilEnergy
    halves: Halves
    strains: CornerStrains


Maker: TypeAlias = Callable[[Scene, Structure, IntArray], Corners | None]


def _none(scene: Scene, structure: Structure, inside: IntArray) -> None:
    """Rods without frames in space are straight, and so are their joints."""
    return None


def _framed(scene: Scene, structure: Structure, inside: IntArray) -> Corners | None:
    corners, dofs, frames = structure.skeleton.corners, structure.dofs, structure.rod_frames
    if not len(corners.triples):
        return None
    assert isinstance(frames, RodFrames)
    places = frames.director_places(corners.pairs).reshape(-1, 12)
    rest = frames.transport(frames.rest(structure.rest), structure.rest)
    d, f = joint_frames(structure.positions, corners.triples, rest.auxiliary, places, corners.signs)
    cosines = np.einsum("icJ,jcJ->Jij", d, f)
    # a curvature 1 is a turn about m2, a curvature 2 one about m1
    names = ("torsional", "bending_2", "bending_1")
    stiff = np.stack([of_edges(scene.geometry, structure.skeleton, name) for name in names], axis=1)
    compliance = corners.halves[:, :, None] * (1.0 / stiff)[corners.pairs]
    of_e = compliance[:, 0, :, None] * np.eye(3)
    of_f = np.einsum("Jik,Jk,Jjk->Jij", cosines, compliance[:, 1], cosines)
    stiffness = np.linalg.inv(of_e + of_f)
    rows, columns = np.triu_indices(3)
    halves = halves_in_space(corners, np.arange(len(cosines)), cosines)
    energy = StencilEnergy.of(
        _NAME,
        RIGID_JOINT,
        np.concatenate((node_dofs(dofs, corners.triples), dofs.of_angles(corners.pairs)), axis=1),
        {
            **dict(zip(RIGID_JOINT.naturals, halves.natural(scene), strict=True)),
            **dict(zip(STIFFNESS, stiffness[:, rows, columns].T, strict=True)),
            **dict(zip(COSINES, cosines.reshape(-1, 9).T, strict=True)),
            "sign_e": corners.signs[:, 0],
            "sign_f": corners.signs[:, 1],
            "twist_e": compliance[:, 0, 0],
            "twist_f": compliance[:, 1, 0],
        },
        places,
    )
    strains = FramedCorners(
        corners.triples,
        corners.voronoi,
        places,
        corners.signs,
        np.ascontiguousarray(cosines.reshape(-1, 9).T),
        np.ascontiguousarray(stiffness.transpose(1, 2, 0)),
        _NAME,
    )
    return Corners(energy, halves, strains)


def _planar(scene: Scene, structure: Structure, inside: IntArray) -> Corners | None:
    corners, dofs = structure.skeleton.corners, structure.dofs
    if not len(corners.triples):
        return None
    names = ("bending_1", "bending_2")
    both = np.stack([of_edges(scene.geometry, structure.skeleton, name) for name in names])
    stiff = both[inside[corners.rods, 0], corners.pairs]
    stiffness = corners.voronoi / (corners.halves / stiff).sum(axis=1)
    angle = planar_angles(dofs.positions(structure.rest), corners.triples)
    halves = halves_in_plane(corners, np.arange(len(angle)), inside)
    energy = StencilEnergy.of(
        _NAME,
        CORNER_PLANAR,
        node_dofs(dofs, corners.triples),
        {
            "kappa": halves.natural(scene)[0],
            "EI": stiffness,
            "voronoi": corners.voronoi,
            "cos_phi0": np.cos(angle),
            "sin_phi0": np.sin(angle),
        },
    )
    strains = PlanarCorners(corners.triples, corners.voronoi, angle, stiffness, _NAME)
    return Corners(energy, halves, strains)


CORNERS: Mapping[Bending, Maker] = {
    Bending.FRAMED: _framed,
    Bending.PLANAR: _planar,
    Bending.ISOTROPIC: _none,
}
"""What makes the corners of rods that bend one way or another."""
