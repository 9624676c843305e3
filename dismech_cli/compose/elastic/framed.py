"""Bending and twist of rods with frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ...energies.bend_twist import BEND_TWIST
from ...kinematics.rod_frames import RodFrames
from ...kinematics.strains import curvature_binormal, material_curvatures
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..structure.joints import Joints
from ..structure.structure import Structure
from .halves import Halves, halves_in_space
from .joints import in_series, natural_density, node_dofs


def framed_bending(
    scene: Scene, structure: Structure, stiffness: FloatArray
) -> tuple[StencilEnergy, Halves, IntArray]:
    """Bending and twisting energy of the joints, those between rods, and the places of directors (J, 12).

    Args:
        scene: The scene.
        structure: What moves.
        stiffness: EI1 and EI2 of each joint [N m^2], shape (2, J).

    Raises:
        ScenarioError: A list of natural strains does not fit.
    """
    dofs, rest, skeleton, frames = structure.dofs, structure.rest, structure.skeleton, structure.rod_frames
    assert isinstance(frames, RodFrames)
    j = skeleton.joints
    places = frames.director_places(j.pairs).reshape(-1, 12)
    trial = frames.transport(frames.rest(rest), rest)
    rest_twist = trial.state.reference_twist
    binormal = curvature_binormal(skeleton.positions, j.triples)
    curvature = material_curvatures(binormal, trial.auxiliary, places, j.signs, rest_twist, rest_twist)
    torsion = rest_twist.copy()
    for index in range(len(scene.geometry.rods)):
        members = j.rod == index
        for row, name in ((curvature[0], "curvature_1"), (curvature[1], "curvature_2"), (torsion, "twist")):
            density = natural_density(scene, j, index, name)
            if density is not None:
                row[members] = density[j.number[members]] * j.voronoi[members]
    welds = _between(j, rest_twist)
    grown = welds.natural(scene)
    for row, more in zip((curvature[0], curvature[1], torsion), grown, strict=True):
        row[welds.stencils] += more
    stencil = np.concatenate((node_dofs(dofs, j.triples), dofs.of_angles(j.pairs)), axis=1)
    torsional = in_series(scene.geometry, skeleton, "torsional")
    energy = StencilEnergy.of(
        "bending and twist",
        BEND_TWIST,
        stencil,
        {
            "kappa_1": curvature[0],
            "kappa_2": curvature[1],
            "twist": torsion,
            "EI_1": stiffness[0],
            "EI_2": stiffness[1],
            "GJ": torsional,
            "voronoi": j.voronoi,
            "sign_e": j.signs[:, 0],
            "sign_f": j.signs[:, 1],
            "cos_psi": np.cos(rest_twist),
            "sin_psi": np.sin(rest_twist),
            "psi": rest_twist,
        },
        np.column_stack((places, frames.twist_places(np.arange(len(j.pairs))))),
    )
    return energy, welds, places


def _between(joints: Joints, rest_twist: FloatArray) -> Halves:
    """The joints between rods, their natural strains in the order of the kernel.

    Those of the second rod are turned by the rest twist, which is the angle of its directors.
    """
    stencils = np.flatnonzero(joints.rod < 0)
    cosines = np.zeros((len(stencils), 3, 3))
    cosines[:, 0, 0] = 1.0
    cosines[:, 1, 1] = cosines[:, 2, 2] = np.cos(rest_twist[stencils])
    cosines[:, 2, 1] = np.sin(rest_twist[stencils])
    cosines[:, 1, 2] = -cosines[:, 2, 1]
    turning = halves_in_space(joints.some(joints.rod < 0), stencils, cosines)
    # a curvature 1 turns about the second director, a curvature 2 back about the first
    responses = {
        name: np.stack((w[:, 2], -w[:, 1], w[:, 0]), axis=1) for name, w in turning.responses.items()
    }
    return replace(turning, responses=responses)
