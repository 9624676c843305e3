"""Bodies of a scene that may touch each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, IntArray
from ...contact.nearby.neighbours import Neighbours
from ...contact.pieces.lines import Lines
from ..scene import Scene
from ..structure.structure import Structure
from .pairs import Tables, body_pairs

# Lines of one body that are nearer at rest than they are thick touch from this share of that distance on.
_TIGHT = 0.999


def make_neighbours(
    scene: Scene, structure: Structure, lines: Lines, stiffness: FloatArray, beside: IntArray
) -> Neighbours | None:
    """Which rods may touch each other; None if none may.

    Args:
        scene: The scene.
        structure: Its nodes and DOFs.
        lines: All lines.
        stiffness: Of each at factor one.
        beside: Keys of pairs of lines that are too near along a body.
    """
    shells = scene.geometry.shell_keys
    pairs = [
        pair for pair in body_pairs(scene.scenario) if pair.first not in shells and pair.second not in shells
    ]
    if not pairs:
        return None
    tables = Tables.of(len(lines.names), pairs, range(len(lines.names)))
    involved = np.flatnonzero((tables.labels >= 0).any(axis=1))
    nothing = np.empty(0, dtype=np.int64)
    found = Neighbours(
        lines=lines,
        numbers=np.flatnonzero(np.isin(lines.bodies, involved)),
        stiffness=stiffness,
        labels=tables.labels,
        signs=tables.signs,
        friction=tables.friction,
        excluded=beside,
        tight=nothing,
        tight_reach=np.empty(0),
        map=structure.dofs,
    )
    return _with_tight(found, structure.dofs.space_positions(structure.rest))


def _with_tight(found: Neighbours, x: FloatArray) -> Neighbours:
    """With the reach of pairs within a body that are nearer at rest than they are thick."""
    near = found.search(x, 0.0)
    near = near[found.lines.bodies[near[:, 0]] == found.lines.bodies[near[:, 1]]]
    distance = found.distances(x, near)
    tight = distance < found.reach(near)
    return replace(found, tight=found.keys(near[tight]), tight_reach=_TIGHT * distance[tight])
