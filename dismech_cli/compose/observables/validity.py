"""Limits of the models of a scene: no more than it has bodies for."""

from __future__ import annotations

from math import degrees, pi

import numpy as np

from ...arrays import FloatArray
from ...kinematics.strains import rest_metric
from ...run.observables.bounds import SlightStrain, SlightTurns
from ...run.observables.limits import (
    CornerBend,
    CornerTurn,
    Fold,
    LostArea,
    MembraneStrain,
    RodBend,
    RodStrain,
    RodTurn,
    folds,
    turns,
)
from ...run.validity import Check
from ..elastic.rods import RodEnergies
from ..scene import Scene
from ..structure.joints import Joints
from ..structure.structure import Structure

SMALL_STRAIN = 0.2  # that linear stretching means
COLLAPSED = 0.99  # of its area lost
FOLDED = 5.0 / 6.0 * pi  # [rad] between two triangles: one has turned over, or lies on the other
SHARP = 0.5 * pi  # [rad] at one joint
_ITS_RADIUS = 1.0  # of curvature, in units of the radius of the rod
_TIGHT = "tighter than a rod of that radius can"
_FURTHER = "linear materials mean up to 20 %; those of model neo_hookean stretch further"


def make_checks(scene: Scene, structure: Structure, rods: RodEnergies) -> tuple[Check, ...]:
    """What a run of this scene must not pass unseen."""
    return (
        *_membranes(scene),
        *_triangles(scene, structure),
        *_edges(scene, rods),
        *_joints(scene, structure),
        *_corners(scene, structure, rods),
    )


def _membranes(scene: Scene) -> list[Check]:
    geometry = scene.geometry
    linear = np.array([sheet.model == "st_venant_kirchhoff" for sheet in geometry.sheets], dtype=bool)
    triangles = geometry.triangles[linear[geometry.triangle_shell]]
    if not len(triangles):
        return []
    measure = MembraneStrain(triangles, rest_metric(geometry.nodes, triangles))
    told = "a membrane is strained by {:.0%}".format
    return [Check(measure, SMALL_STRAIN, triangles[:, 0], told, _FURTHER)]


def _triangles(scene: Scene, structure: Structure) -> list[Check]:
    geometry = scene.geometry
    triangles = geometry.triangles
    if not len(triangles):
        return []
    lost = Check(
        LostArea(triangles, geometry.areas),
        COLLAPSED,
        triangles[:, 0],
        lambda value: f"a triangle shrinks to {1.0 - value:.2g} of its area",
        "the mesh cannot follow; refine it, or load less",
    )
    bodies = structure.shell_edges.bodies
    pairs = np.concatenate(
        [geometry.triangles_of(name)[body.topology.hinge_faces] for name, body in bodies.items()]
    )
    folded = Check(
        Fold(triangles, pairs, folds(geometry.nodes, triangles, pairs)),
        FOLDED,
        triangles[pairs[:, 0], 0],
        lambda value: f"a shell folds by {degrees(value):.0f} deg between two triangles",
        "they turn over or lie on each other; refine the mesh, or load less",
    )
    return [lost, folded] if len(pairs) else [lost]


def _edges(scene: Scene, rods: RodEnergies) -> list[Check]:
    geometry, stretch = scene.geometry, rods.stretch
    if stretch is None:
        return []
    linear = np.flatnonzero(stretch.parameter("EA") > 0.0)
    if not len(linear):
        return []
    edges, rest = geometry.edges[linear], stretch.parameter("length")[linear]
    measure = RodStrain(edges, rest, stretch.name, linear)
    bound = SlightStrain.of(edges, rest, stretch.name, linear, SMALL_STRAIN)
    told = "a rod is strained by {:.0%}".format
    return [Check(measure, SMALL_STRAIN, edges[:, 0], told, _FURTHER, bound)]


def _joints(scene: Scene, structure: Structure) -> list[Check]:
    joints, rest = structure.skeleton.joints, structure.positions
    triples = joints.triples
    if not len(triples):
        return []
    at_rest = turns(rest, triples)
    bend = RodBend(triples, _thicker(scene, structure, joints) / joints.voronoi, 2.0 * np.tan(0.5 * at_rest))
    bound = SlightTurns.of(triples, np.minimum(SHARP + at_rest, bend.turns_to(_ITS_RADIUS)))
    turned = Check(
        RodTurn(triples, at_rest),
        SHARP,
        triples[:, 1],
        lambda value: f"a rod turns by {degrees(value):.0f} deg at one node",
        "a finer mesh would turn by less",
        bound,
    )
    bent = Check(
        bend,
        _ITS_RADIUS,
        triples[:, 1],
        lambda value: f"a rod bends to {1.0 / value:.2g} of its own radius",
        _TIGHT,
        bound,
    )
    return [turned, bent]


def _corners(scene: Scene, structure: Structure, rods: RodEnergies) -> list[Check]:
    """Two edges at an angle; the edges at a hub, each against the others."""
    if rods.corners is None:
        return []
    strains, corners = rods.corners.strains, structure.skeleton.corners
    turned = Check(
        CornerTurn(strains, corners.voronoi),
        SHARP,
        strains.nodes,
        lambda value: f"rods turn by {degrees(value):.0f} deg against each other at a joint or corner",
        "a finer mesh would turn by less",
    )
    bent = Check(
        CornerBend(strains, _thicker(scene, structure, corners)),
        1.0,
        strains.nodes,
        lambda value: f"a rod bends to {1.0 / value:.2g} of its own radius at a joint or corner",
        _TIGHT,
    )
    return [turned, bent]


def _thicker(scene: Scene, structure: Structure, joints: Joints) -> FloatArray:
    """Radius of the thicker edge of each joint [m], shape (J,)."""
    radius = scene.geometry.per_edge("radius")
    thicker: FloatArray = np.concatenate((radius, radius[structure.skeleton.owners]))[joints.pairs].max(
        axis=1
    )
    return thicker
