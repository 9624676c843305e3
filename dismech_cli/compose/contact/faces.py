"""Lines of a scene and the shells that they may touch."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...contact.nearby.faces import Faces
from ...contact.nearby.surface_exclusion import with_exclusions
from ...contact.pieces.lines import Lines
from ...contact.pieces.surface import Surface
from ..bodies.geometry import Geometry
from ..scene import Scene
from ..structure.masses import nodal_mass
from ..structure.structure import Structure
from .pairs import Tables, body_pairs


def make_faces(
    scene: Scene,
    structure: Structure,
    lines: Lines,
    stiffness: FloatArray,
    beside: IntArray,
    sides: IntArray,
    reach: float,
) -> Faces | None:
    """Who may touch shells; None if nothing may.

    Args:
        scene: The scene.
        structure: Its nodes and DOFs.
        lines: All lines.
        stiffness: Of each at factor one.
        beside: Keys of pairs of lines that are too near along a body.
        sides: Lines that are the sides of each triangle, shape (T, 3).
        reach: Distance at which lines begin to push, as a share of that at which surfaces touch.
    """
    geometry = scene.geometry
    shells = np.array(geometry.shell_keys, dtype=np.int64)
    pairs = [
        pair
        for pair in body_pairs(scene.scenario)
        if pair.first in geometry.shell_keys or pair.second in geometry.shell_keys
    ]
    if not pairs:
        return None
    tables = Tables.of(len(lines.names), pairs, geometry.shell_keys)
    involved = np.flatnonzero((tables.labels >= 0).any(axis=1))
    mass = nodal_mass(geometry, len(structure.positions), structure.payload)
    bodies = shells[geometry.triangle_shell]
    found = Faces(
        lines=lines,
        numbers=np.flatnonzero(np.isin(lines.bodies, involved)),
        surface=Surface(
            nodes=geometry.triangles,
            halves=0.5 * reach * geometry.per_triangle("thickness"),
            masses=mass[geometry.triangles].mean(axis=1),
            bodies=bodies,
        ),
        # of two shells the lines of either hold half
        masses=np.where(np.isin(lines.bodies, shells), 0.5, 1.0) * lines.masses,
        stiffness=_stiffness(lines, stiffness, shells),
        labels=tables.labels,
        signs=tables.signs,
        friction=tables.friction,
        excluded=np.empty(0, dtype=np.int64),
        own_reach=np.full(len(lines.nodes), np.inf),
        map=structure.dofs,
    )
    line_pairs = np.stack(np.divmod(beside, len(lines.nodes)), axis=1)
    x = structure.dofs.space_positions(structure.rest)
    return with_exclusions(found, x, line_pairs, sides)


def _stiffness(lines: Lines, stiffness: FloatArray, shells: IntArray) -> FloatArray:
    """Of lines of a body (first index) against a shell at factor one.

    Shells [N/m^3] have the greater of both, half of it on each side. Rods [N/m^2] carry the weight of a
    strip of the shell as wide as they are themselves, or their own.
    """
    count = len(lines.names)
    body, width = np.zeros(count), np.zeros(count)
    np.maximum.at(body, lines.bodies, stiffness)
    np.maximum.at(width, lines.bodies, 2.0 * lines.radii)
    is_shell = np.isin(np.arange(count), shells)[:, None]
    both = np.maximum(body[:, None], body)
    return np.where(is_shell, 0.5 * both, np.maximum(body[:, None], width[:, None] * body))


def sides_of_triangles(geometry: Geometry, lines: Lines) -> IntArray:
    """Lines that are the sides of each triangle of all shells, shape (T, 3)."""
    count = len(geometry.nodes)
    bodies = np.array(geometry.shell_keys, dtype=np.int64)[geometry.triangle_shell]

    def keys(ends: IntArray, body: IntArray) -> IntArray:
        ends = np.sort(ends, axis=-1)
        out: IntArray = (body * count + ends[..., 0]) * count + ends[..., 1]
        return out

    own = keys(lines.nodes, lines.bodies)
    order = np.argsort(own)
    following = np.roll(geometry.triangles, -1, axis=1)
    wanted = keys(np.stack((geometry.triangles, following), axis=-1), bodies[:, None])
    return order[np.searchsorted(own[order], wanted)]
