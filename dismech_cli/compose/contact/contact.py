"""Contact of the scene as a term of the model."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from ...arrays import FloatArray, IntArray
from ...contact.contact import Contact, Friction, along_lines
from ...contact.law.stiffness import Given, Rule, Tolerant
from ...contact.nearby.exclusion import near_along
from ...contact.nearby.faces import Faces
from ...contact.nearby.neighbours import Neighbours
from ...contact.obstacles.anchored_wall import AnchoredWall
from ...contact.obstacles.walls import Wall
from ...contact.pairs.anchored_pairs import AnchoredPairs
from ...contact.pieces.lines import Lines
from ...contact.terms import AnchoredFriction, FullFriction, SymmetricFriction
from ...scenario.language.contact import CompatLaw, Law, PenaltyLaw
from ...scenario.language.contact import Contact as ContactSpec
from ..scene import Scene
from ..structure.structure import Structure
from ..touching import named_pairs
from .faces import make_faces, sides_of_triangles
from .family import Family
from .guards import make_guards
from .lines import make_lines
from .neighbours import make_neighbours
from .obstacles import make_obstacle
from .pairs import Pair, body_pairs, wall_pairs

# At factor one weight alone presses bodies in by this part of the tolerance.
_RESTING = 0.5
# Anchored friction is full on this part of the least thickness.
_LENGTH = 1e-3


def make_contact(scene: Scene, structure: Structure) -> Contact:
    """Contact as the scene asks for it.

    Raises:
        ScenarioError: It asks for what cannot be.
    """
    spec = scene.scenario.contact
    assert spec is not None
    reach = spec.law.reach
    lines = make_lines(scene, structure, reach)
    bodies = body_pairs(scene.scenario)
    rule, stiffness = _hardness(spec.law, lines)
    walls = tuple(_walls(scene, structure, lines, stiffness, wall_pairs(scene.scenario)))
    beside = _beside(lines, structure) if bodies else np.empty(0, dtype=np.int64)
    neighbours = make_neighbours(scene, structure, lines, stiffness, beside)
    sides = sides_of_triangles(scene.geometry, lines)
    finding = along_lines if not isinstance(spec.law, CompatLaw) else Family(spec.law, sides)
    faces = make_faces(scene, structure, lines, stiffness, beside, sides, reach)
    return Contact(
        map=structure.dofs,
        lines=lines,
        walls=walls,
        neighbours=neighbours,
        faces=faces,
        rule=rule,
        friction=_friction(spec, lines, among_bodies=bool(bodies)),
        guards=make_guards(
            spec.law,
            *(_smooth(walls, neighbours, faces) if _anchored(spec) else (walls, neighbours, faces)),
            sides,
            structure.dofs.space_positions(structure.rest),
        ),
        pairs=tuple(named_pairs(scene.scenario)),
        finding=finding,
    )


def _anchored(spec: ContactSpec) -> bool:
    return spec.friction is not None and spec.friction.stick == "anchored"


def _smooth(
    walls: tuple[Wall, ...], neighbours: Neighbours | None, faces: Faces | None
) -> tuple[tuple[Wall, ...], Neighbours | None, Faces | None]:
    """All without friction: anchors are of lines, and what a core holds has none."""
    return (
        tuple(replace(wall, friction=np.zeros_like(wall.friction)) for wall in walls),
        neighbours and replace(neighbours, friction=np.zeros_like(neighbours.friction)),
        faces and replace(faces, friction=np.zeros_like(faces.friction)),
    )


def _beside(lines: Lines, structure: Structure) -> IntArray:
    """Pairs of lines that are too near along a body to touch; see :func:`.near_along`."""
    return near_along(lines.nodes, lines.lengths, lines.radii, structure.dofs.n_nodes)


def _hardness(law: Law, lines: Lines) -> tuple[Rule, FloatArray]:
    """The rule, and the stiffness of each line at factor one: that which carries its weight."""
    match law:
        case PenaltyLaw(stiffness=float() as given) | CompatLaw(stiffness=given):
            return Given(), np.full(len(lines.nodes), given)
        case _:
            allowed = law.allowed
    assert allowed is not None
    return Tolerant(allowed), lines.loads / (2.0 * _RESTING * allowed * 2.0 * lines.radii)


def _friction(spec: ContactSpec, lines: Lines, *, among_bodies: bool) -> Friction | None:
    rough = spec.friction
    if rough is None:
        return None
    if _anchored(spec):
        length = _LENGTH * 2.0 * float(lines.radii.min()) if rough.slip_length is None else rough.slip_length
        return Friction(
            length,
            AnchoredFriction,
            partial(AnchoredWall, length=length),
            partial(AnchoredPairs, length=length),
        )
    match rough.tangent:
        case "full":
            kind: type[FullFriction] | type[SymmetricFriction] = FullFriction
        case "symmetric":
            kind = SymmetricFriction
        case "auto":
            kind = SymmetricFriction if among_bodies else FullFriction
    return Friction(rough.slip_speed, kind)


def _walls(
    scene: Scene, structure: Structure, lines: Lines, stiffness: FloatArray, pairs: list[Pair]
) -> list[Wall]:
    walls = []
    for index in range(len(scene.scenario.obstacles)):
        mine = [pair for pair in pairs if pair.second == index]
        if not mine:
            continue
        friction, label = np.zeros(len(lines.names)), np.full(len(lines.names), -1)
        for pair in mine:
            friction[pair.first], label[pair.first] = pair.friction, pair.label
        numbers = np.flatnonzero(label[lines.bodies] >= 0)
        bodies = lines.bodies[numbers]
        walls.append(
            Wall(
                obstacle=make_obstacle(scene, index),
                lines=lines.some(numbers),
                numbers=numbers,
                stiffness=stiffness[numbers],
                friction=friction[bodies],
                labels=label[bodies],
                map=structure.dofs,
            )
        )
    return walls
