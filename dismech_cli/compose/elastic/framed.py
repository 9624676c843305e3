"""Bending and twist of rods with frames."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...energies.bend_twist import BEND_TWIST
from ...kinematics.rod_frames import RodFrames
from ...kinematics.strains import material_curvatures
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..structure.structure import Structure
from .joints import in_series, natural_density, node_dofs


def framed_bending(
    scene: Scene, structure: Structure, stiffness: FloatArray
) -> tuple[StencilEnergy, IntArray]:
    """Bending and twisting energy of the joints, and the places of their directors, shape (J, 12).

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
    curvature = material_curvatures(
        skeleton.positions, j.triples, trial.auxiliary, places, j.signs, rest_twist, rest_twist
    )
    torsion = rest_twist.copy()
    for index in range(len(scene.geometry.rods)):
        members = j.rod == index
        for row, name in ((curvature[0], "curvature_1"), (curvature[1], "curvature_2"), (torsion, "twist")):
            density = natural_density(scene, j, index, name)
            if density is not None:
                row[members] = density[j.number[members]] * j.voronoi[members]
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
    return energy, places
