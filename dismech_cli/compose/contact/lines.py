"""The edges of all bodies as lines with a thickness."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...contact.lines import Lines
from ...mesh.measure import edge_lengths
from ...mesh.topology.sides import half_edges
from ...scenario.language.force import Gravity, Point
from ...scenario.values.law import LawSpec
from ..laws import components
from ..scene import Scene
from ..structure.masses import nodal_mass
from ..structure.structure import Structure

# Times at which the weight is looked at.
_LOOKS = 11
# Where nothing weighs anything, contact starts as stiff as this acceleration asks for [m/s^2].
_LEAST_WEIGHT = 1.0


def make_lines(scene: Scene, structure: Structure) -> Lines:
    """Edges of rods as they are, of shells with the width that each stands for: a third of its triangles.

    Bodies are numbered as in the scenario.
    """
    geometry = scene.geometry
    names = tuple(body.name for body in scene.scenario.geometry)
    pull = max(_gravity(scene), _LEAST_WEIGHT)
    rods = np.array(geometry.rod_keys, dtype=np.int64)[geometry.edge_rod]
    nodes, lengths = [geometry.edges], [geometry.lengths]
    radii, weights = [geometry.per_edge("radius")], [np.ones(len(geometry.edges))]
    loads, bodies = [pull * geometry.per_edge("mass_per_length")], [rods]
    for key, shell, sheet in zip(geometry.shell_keys, geometry.shells, geometry.sheets, strict=True):
        own = geometry.triangles_of(shell.name)
        sides, width = _sides(geometry.nodes, geometry.triangles[own], geometry.areas[own])
        count = len(sides)
        nodes.append(sides)
        lengths.append(edge_lengths(geometry.nodes, sides))
        radii.append(np.full(count, 0.5 * sheet.thickness))
        weights.append(width)
        loads.append(np.full(count, pull * sheet.mass_per_area))
        bodies.append(np.full(count, key))
    ends, all_lengths, strips = np.concatenate(nodes), np.concatenate(lengths), np.concatenate(weights)
    pulls = _pulls(scene, float(all_lengths.sum()))
    mass = nodal_mass(geometry, len(structure.positions), structure.payload)
    return Lines(
        ends,
        all_lengths,
        np.concatenate(radii),
        strips,
        mass[ends].sum(axis=1),
        np.concatenate(loads) + pulls / strips,
        np.concatenate(bodies),
        names,
    )


def _sides(positions: FloatArray, triangles: IntArray, areas: FloatArray) -> tuple[IntArray, FloatArray]:
    """Edges of a shell, each once, and the width of the strip that each stands for [m]."""
    halves = np.sort(half_edges(triangles), axis=1)
    sides, of = np.unique(halves, axis=0, return_inverse=True)
    shares = np.repeat(areas / 3.0, 3)
    width = np.bincount(of.reshape(-1), weights=shares, minlength=len(sides))
    return sides, width / edge_lengths(positions, sides)


def _gravity(scene: Scene) -> float:
    """Largest acceleration of free fall [m/s^2]."""
    forces = scene.scenario.forces
    return max((_largest(scene, f.acceleration) for f in forces if isinstance(f, Gravity)), default=0.0)


def _pulls(scene: Scene, length: float) -> float:
    """Point loads, as if spread over all bodies [N/m]: what these press on has to carry as much."""
    total = 0.0
    for index, force in enumerate(scene.scenario.forces):
        if isinstance(force, Point):
            total += len(scene.places.nodes(("forces", index, "where"))) * _largest(scene, force.force)
    return total / length


def _largest(scene: Scene, vector: Sequence[LawSpec]) -> float:
    """Largest magnitude of a vector of laws in the run."""
    end = scene.scenario.numerics.t_end or 1.0
    laws = components(vector, scene.laws)
    times = np.linspace(0.0, end, _LOOKS).tolist()
    return max(float(np.linalg.norm([float(law(t)) for law in laws])) for t in times)
