"""Actuation of rods as drives of natural strains."""

from __future__ import annotations

import numpy as np

from ..model.driven import Drive, DrivenEnergy
from ..model.stencil import StencilEnergy
from ..scenario.actuation import DihedralActuation
from ..scenario.load import LoadedScenario
from .geometry import Geometry
from .laws import ToLaw
from .plan import Bending, Plan
from .rods import RodSystem
from .skeleton import Skeleton

ROWS = {"curvature_1": 0, "curvature_2": 1, "twist": 0}


def build_rod_elastic(
    loaded: LoadedScenario, geometry: Geometry, plan: Plan, skeleton: Skeleton, rods: RodSystem, laws: ToLaw
) -> tuple[StencilEnergy | DrivenEnergy, ...]:
    """The elastic energies of the rods, driven where the scenario actuates them.

    Raises:
        ScenarioError: An actuation acts out of plane, or its joints do not exist.
    """
    drives: dict[str, list[Drive]] = {"stretch": [], "bending": [], "twist": []}
    for index, actuation in enumerate(loaded.scenario.actuation):
        if isinstance(actuation, DihedralActuation):
            continue
        rod = [r.name for r in geometry.rods].index(actuation.rod)
        law = laws(actuation.value)
        path = ("actuation", index)
        if actuation.type == "stretch":
            stencils = geometry.rod_edges[actuation.rod]
            number = np.arange(len(stencils))
            factors = np.ones(len(stencils))
        else:
            stencils = np.flatnonzero(skeleton.joints.rod == rod)
            number = skeleton.joints.number[stencils]
            factors = skeleton.joints.voronoi[stencils].copy()
        count = int(number.max(initial=-1)) + 1
        places = number / max(count - 1, 1)
        if actuation.joints is not None:
            first, last = actuation.joints
            if last >= count:
                raise loaded.error((*path, "joints"), f"rod '{actuation.rod}' has {count}, counted from 0")
            chosen = (number >= first) & (number <= last)
            stencils, places, factors = stencils[chosen], places[chosen], factors[chosen]
        row = ROWS.get(actuation.type, 0)
        target = actuation.type if actuation.type in ("stretch", "twist") else "bending"
        if plan.bending is Bending.PLANAR and actuation.type != "stretch":
            component, sign = rods.in_plane[rod]
            if actuation.type == "twist" or row != component:
                raise loaded.error((*path, "type"), f"{actuation.type} acts out of the plane of the scene")
            row, factors = 0, sign * factors
        drives[target].append(Drive(row, stencils, law, places, factors))
    energies = (rods.stretch, rods.bending, rods.twist)
    return tuple(
        DrivenEnergy(energy, tuple(drives[energy.name])) if drives[energy.name] else energy
        for energy in energies
        if energy is not None
    )
