"""Actuation of rods as drives of natural strains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...model.driven import Drive, DrivenEnergy
from ...model.stencil import StencilEnergy
from ...scenario.language.actuation import (
    Controlled,
    CurvatureActuation,
    RodActuation,
    ShellActuation,
    StretchActuation,
    TwistActuation,
)
from ...scenario.text.tree import KeyPath
from ..laws import NOWHERE
from ..scene import Scene
from ..structure.plan import Bending
from ..structure.structure import Structure
from .following import Following, Ports, following
from .halves import Halves
from .rods import RodEnergies
from .stiffening import Stiffening, refuse_shared, stiffened, surplus

# Rows of natural strains: of an edge, of a framed joint.
ROWS = {"stretch": 0, "curvature_1": 0, "curvature_2": 1, "twist": 2}


@frozen
class DrivenRods:
    """The elastic energies of the rods under actuation.

    Attributes:
        terms: The energies, driven where the scenario actuates them.
        rods: The same before they are driven, as stiff as feedback makes them.
        surplus: What passive springs store beyond those that feedback makes stiffer.
    """

    terms: tuple[StencilEnergy | DrivenEnergy, ...]
    rods: RodEnergies
    surplus: tuple[DrivenEnergy, ...]


def driven_rods(
    scene: Scene,
    structure: Structure,
    rods: RodEnergies,
    welds: Sequence[tuple[StencilEnergy, Halves]],
    ports: Ports,
) -> DrivenRods:
    """The elastic energies of the rods, driven where the scenario actuates them.

    Args:
        scene: The scene.
        structure: What moves.
        rods: Energies of the rods.
        welds: Those of rods with shells, and what natural strains do to them.
        ports: Of the controllers.

    Raises:
        ScenarioError: An actuation acts out of plane, its joints do not exist, or two controllers drive one.
    """
    of_edges: list[Drive] = []
    of_joints: list[Drive] = []
    of_corners: list[Drive] = []
    of_welds: list[list[Drive]] = [[] for _ in welds]
    stiff_edges: list[Stiffening] = []
    stiff_joints: list[Stiffening] = []
    kinks = None if rods.corners is None else rods.corners.halves
    for index, actuation in enumerate(scene.scenario.actuation):
        if isinstance(actuation, ShellActuation):
            continue
        path, follow = ("actuation", index), following(scene, ports, index, actuation.value)
        rod = [r.name for r in scene.geometry.rods].index(actuation.rod)
        p = ports[index].p if isinstance(actuation.value, Controlled) else 0.0
        if actuation.type == "stretch":
            drive = _edge_drive(scene, actuation, path, follow)
            of_edges.append(drive)
            stiff_edges += [Stiffening((*path, "value"), drive, p)] if p else []
            continue
        drive = _joint_drive(scene, structure, rods, actuation, path, follow)
        halves = [
            list(_half_drives(some, rod, actuation, follow)) for some in (rods.welds, kinks, *_of(welds))
        ]
        of_joints += [drive, *halves[0]]
        of_corners += halves[1]
        for drives, more in zip(of_welds, halves[2:], strict=True):
            drives += more
        if p and any(halves):
            raise scene.error(
                (*path, "value"),
                f"rod '{actuation.rod}' is joined to others, whose joints bend every way with one stiffness; "
                "ideal feedback stiffens springs one by one: take feedback: sampled, or leave these joints "
                "out with 'joints'",
            )
        stiff_joints += [Stiffening((*path, "value"), drive, p)] if p else []
    refuse_shared(scene, of_edges, stiff_edges)
    refuse_shared(scene, of_joints, stiff_joints)
    stiffer = replace(
        rods,
        stretch=None if rods.stretch is None else stiffened(scene, rods.stretch, stiff_edges),
        bending=None if rods.bending is None else stiffened(scene, rods.bending, stiff_joints),
        bending_stiffness=_stiffer(rods.bending_stiffness, stiff_joints),
    )
    driven: list[tuple[StencilEnergy | None, list[Drive]]] = [
        (stiffer.stretch, of_edges),
        (stiffer.bending, of_joints),
        (None if rods.corners is None else rods.corners.energy, of_corners),
        *((energy, drives) for (energy, _), drives in zip(welds, of_welds, strict=True)),
    ]
    terms = tuple(
        DrivenEnergy(energy, tuple(drives)) if drives else energy
        for energy, drives in driven
        if energy is not None
    )
    more_stored = (
        one
        for energy, parts in ((stiffer.stretch, stiff_edges), (stiffer.bending, stiff_joints))
        if energy is not None
        for one in surplus(scene, energy, parts)
    )
    return DrivenRods(terms, stiffer, tuple(more_stored))


def _of(welds: Sequence[tuple[StencilEnergy, Halves]]) -> Iterator[Halves]:
    return (halves for _, halves in welds)


def _edge_drive(scene: Scene, actuation: StretchActuation, path: KeyPath, follow: Following) -> Drive:
    """The drive of the edges of a rod.

    Raises:
        ScenarioError: It has no such edges.
    """
    stencils = scene.geometry.rod_edges[actuation.rod]
    number, count = np.arange(len(stencils)), len(stencils)
    chosen = _in_range(scene, actuation, path, number, count)
    signal = follow(_members(actuation, number[chosen]), NOWHERE)
    places = _places(number[chosen], count)
    return Drive(ROWS["stretch"], stencils[chosen], signal, places, np.ones(len(chosen)))


def _joint_drive(
    scene: Scene,
    structure: Structure,
    rods: RodEnergies,
    actuation: CurvatureActuation | TwistActuation,
    path: KeyPath,
    follow: Following,
) -> Drive:
    """The drive of the joints within a rod.

    Raises:
        ScenarioError: It acts out of plane, or the rod has no such joints.
    """
    joints = structure.skeleton.joints
    rod = [r.name for r in scene.geometry.rods].index(actuation.rod)
    stencils = np.flatnonzero(joints.rod == rod)
    number, count = joints.number[stencils], int(joints.counts[rod])
    chosen = _in_range(scene, actuation, path, number, count)
    row, factors = ROWS[actuation.type], joints.voronoi[stencils]
    if structure.plan.bending is Bending.PLANAR:
        component, sign = rods.in_plane[rod]
        if actuation.type == "twist" or row != component:
            raise scene.error((*path, "type"), f"{actuation.type} acts out of the plane of the scene")
        row, factors = 0, sign * factors
    signal = follow(_members(actuation, number[chosen]), NOWHERE)
    return Drive(row, stencils[chosen], signal, _places(number[chosen], count), factors[chosen])


def _in_range(scene: Scene, actuation: RodActuation, path: KeyPath, number: IntArray, count: int) -> IntArray:
    """Which of some edges or joints are driven.

    Raises:
        ScenarioError: The rod has fewer.
    """
    if actuation.joints is not None and actuation.joints[1] >= count:
        raise scene.error((*path, "joints"), f"rod '{actuation.rod}' has {count}, counted from 0")
    return _chosen(actuation, number)


def _stiffer(stiffness: FloatArray, parts: Sequence[Stiffening]) -> FloatArray:
    """Bending stiffness by direction (2, J) under feedback; twist is none of it."""
    out = stiffness.copy()
    for part in parts:
        if part.drive.row < len(out):
            out[part.drive.row, part.drive.stencils] *= 1.0 + part.p
    return out


def _half_drives(
    halves: Halves | None, rod: int, actuation: CurvatureActuation | TwistActuation, follow: Following
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
        signal = follow(_members(actuation, number[chosen]), NOWHERE)
        for row, factors in enumerate(response[side][:, mine]):
            if factors.any():
                yield Drive(row, halves.stencils[mine], signal, places, factors)


def _chosen(actuation: RodActuation, number: IntArray) -> IntArray:
    """Which of some edges or joints are driven, by their numbers along the rod."""
    if actuation.joints is None:
        return np.arange(len(number))
    first, last = actuation.joints
    return np.flatnonzero((number >= first) & (number <= last))


def _members(actuation: StretchActuation | CurvatureActuation | TwistActuation, number: IntArray) -> IntArray:
    """Which of the driven edges or joints each of some is, by their numbers along the rod."""
    return number - (0 if actuation.joints is None else actuation.joints[0])


def _places(number: IntArray, count: int) -> FloatArray:
    """Place of each in [0, 1] along the rod."""
    return number / max(count - 1, 1)
