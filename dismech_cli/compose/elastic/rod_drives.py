"""Actuation of rods as drives of natural strains."""

from __future__ import annotations

import numpy as np

from ...model.driven import Drive, DrivenEnergy
from ...model.stencil import StencilEnergy
from ...scenario.language.actuation import ShellActuation
from ..scene import Scene
from ..structure.plan import Bending
from ..structure.structure import Structure
from .rods import RodEnergies

# Rows of natural strains: of an edge, of a framed joint.
ROWS = {"stretch": 0, "curvature_1": 0, "curvature_2": 1, "twist": 2}


def driven_rods(
    scene: Scene, structure: Structure, rods: RodEnergies
) -> tuple[StencilEnergy | DrivenEnergy, ...]:
    """The elastic energies of the rods, driven where the scenario actuates them.

    Raises:
        ScenarioError: An actuation acts out of plane, or its joints do not exist.
    """
    geometry, joints = scene.geometry, structure.skeleton.joints
    of_edges: list[Drive] = []
    of_joints: list[Drive] = []
    for index, actuation in enumerate(scene.scenario.actuation):
        if isinstance(actuation, ShellActuation):
            continue
        rod = [r.name for r in geometry.rods].index(actuation.rod)
        law = scene.laws(actuation.value)
        path = ("actuation", index)
        if actuation.type == "stretch":
            stencils = geometry.rod_edges[actuation.rod]
            number = np.arange(len(stencils))
            factors = np.ones(len(stencils))
        else:
            stencils = np.flatnonzero(joints.rod == rod)
            number = joints.number[stencils]
            factors = joints.voronoi[stencils].copy()
        count = int(number.max(initial=-1)) + 1
        places = number / max(count - 1, 1)
        if actuation.joints is not None:
            first, last = actuation.joints
            if last >= count:
                raise scene.error((*path, "joints"), f"rod '{actuation.rod}' has {count}, counted from 0")
            chosen = (number >= first) & (number <= last)
            stencils, places, factors = stencils[chosen], places[chosen], factors[chosen]
        row = ROWS[actuation.type]
        if structure.plan.bending is Bending.PLANAR and actuation.type != "stretch":
            component, sign = rods.in_plane[rod]
            if actuation.type == "twist" or row != component:
                raise scene.error((*path, "type"), f"{actuation.type} acts out of the plane of the scene")
            row, factors = 0, sign * factors
        drives = of_edges if actuation.type == "stretch" else of_joints
        drives.append(Drive(row, stencils, law, places, factors))
    return tuple(
        DrivenEnergy(energy, tuple(drives)) if drives else energy
        for energy, drives in ((rods.stretch, of_edges), (rods.bending, of_joints))
        if energy is not None
    )
