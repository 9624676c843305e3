"""Actuation of rods as drives of natural strains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...laws.signal import Signal
from ...model.driven import Drive, DrivenEnergy
from ...model.stencil import StencilEnergy
from ...scenario.language.actuation import (
    CurvatureActuation,
    ShellActuation,
    StretchActuation,
    TwistActuation,
)
from ..scene import Scene
from ..structure.plan import Bending
from ..structure.structure import Structure
from .halves import Halves
from .rods import RodEnergies

# Rows of natural strains: of an edge, of a framed joint.
ROWS = {"stretch": 0, "curvature_1": 0, "curvature_2": 1, "twist": 2}


def driven_rods(
    scene: Scene, structure: Structure, rods: RodEnergies, welds: Sequence[tuple[StencilEnergy, Halves]]
) -> tuple[StencilEnergy | DrivenEnergy, ...]:
    """The elastic energies of the rods, driven where the scenario actuates them.

    Args:
        scene: The scene.
        structure: What moves.
        rods: Energies of the rods.
        welds: Those of rods with shells, and what natural strains do to them.

    Raises:
        ScenarioError: An actuation acts out of plane, or its joints do not exist.
    """
    geometry, joints = scene.geometry, structure.skeleton.joints
    of_edges: list[Drive] = []
    of_joints: list[Drive] = []
    of_corners: list[Drive] = []
    of_welds: list[list[Drive]] = [[] for _ in welds]
    kinks = None if rods.corners is None else rods.corners.halves
    for index, actuation in enumerate(scene.scenario.actuation):
        if isinstance(actuation, ShellActuation):
            continue
        rod = [r.name for r in geometry.rods].index(actuation.rod)
        law = scene.laws(actuation.value)
        path = ("actuation", index)
        if actuation.type == "stretch":
            stencils = geometry.rod_edges[actuation.rod]
            number, count = np.arange(len(stencils)), len(stencils)
            factors = np.ones(len(stencils))
        else:
            stencils = np.flatnonzero(joints.rod == rod)
            number, count = joints.number[stencils], int(joints.counts[rod])
            factors = joints.voronoi[stencils]
        if actuation.joints is not None and actuation.joints[1] >= count:
            raise scene.error((*path, "joints"), f"rod '{actuation.rod}' has {count}, counted from 0")
        row = ROWS[actuation.type]
        if structure.plan.bending is Bending.PLANAR and actuation.type != "stretch":
            component, sign = rods.in_plane[rod]
            if actuation.type == "twist" or row != component:
                raise scene.error((*path, "type"), f"{actuation.type} acts out of the plane of the scene")
            row, factors = 0, sign * factors
        chosen = _chosen(actuation, number)
        drives = of_edges if actuation.type == "stretch" else of_joints
        places = _places(number[chosen], count)
        drives.append(Drive(row, stencils[chosen], law, places, factors[chosen]))
        if actuation.type != "stretch":
            of_joints += _half_drives(rods.welds, rod, actuation, law)
            of_corners += _half_drives(kinks, rod, actuation, law)
            for weld_drives, (_, halves) in zip(of_welds, welds, strict=True):
                weld_drives += _half_drives(halves, rod, actuation, law)
    corners = None if rods.corners is None else rods.corners.energy
    driven: list[tuple[StencilEnergy | None, list[Drive]]] = [
        (rods.stretch, of_edges),
        (rods.bending, of_joints),
        (corners, of_corners),
        *((energy, drives) for (energy, _), drives in zip(welds, of_welds, strict=True)),
    ]
    return tuple(
        DrivenEnergy(energy, tuple(drives)) if drives else energy
        for energy, drives in driven
        if energy is not None
    )


def _half_drives(
    halves: Halves | None, rod: int, actuation: CurvatureActuation | TwistActuation, law: Signal
) -> Iterator[Drive]:
    """Drives of the halves of a rod's edges where it meets others or itself at an angle."""
    if halves is None:
        return
    joints, response = halves.joints, halves.responses[actuation.type]
    for side in range(2):
        mine = np.flatnonzero(joints.rods[:, side] == rod)
        number = joints.numbers[mine, side]
        chosen = _chosen(actuation, number)
        mine, places = mine[chosen], _places(number[chosen], int(joints.counts[rod]))
        for row, factors in enumerate(response[side][:, mine]):
            if factors.any():
                yield Drive(row, halves.stencils[mine], law, places, factors)


def _chosen(actuation: StretchActuation | CurvatureActuation | TwistActuation, number: IntArray) -> IntArray:
    """Which of some edges or joints are driven, by their numbers along the rod."""
    if actuation.joints is None:
        return np.arange(len(number))
    first, last = actuation.joints
    return np.flatnonzero((number >= first) & (number <= last))


def _places(number: IntArray, count: int) -> FloatArray:
    """Place of each in [0, 1] along the rod."""
    return number / max(count - 1, 1)
