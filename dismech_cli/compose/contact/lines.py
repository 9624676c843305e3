"""The edges of all bodies as lines with a thickness."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...contact.pieces.lines import Lines
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


def make_lines(scene: Scene, structure: Structure, reach: float) -> Lines:
    """Edges of rods as they are, of shells with the width that each stands for: a third of its triangles.

    Bodies are numbered as in the scenario.

    Args:
        scene: The scene.
        structure: Its nodes and DOFs.
        reach: Distance at which lines begin to push, as a share of that at which surfaces touch.
    """
    geometry = scene.geometry
    names = tuple(body.name for body in scene.scenario.geometry)
    pull = max(_gravity(scene), _LEAST_WEIGHT)
    rods = np.array(geometry.rod_keys, dtype=np.int64)[geometry.edge_rod]
    nodes, lengths = [geometry.edges], [geometry.lengths]
    radii, weights = [geometry.per_edge("radius")], [np.ones(len(geometry.edges))]
    loads, bodies = [pull * geometry.per_edge("mass_per_length")], [rods]
    thickness, weight = geometry.per_triangle("thickness"), geometry.per_triangle("mass_per_area")
    for key, shell in zip(geometry.shell_keys, geometry.shells, strict=True):
        own = geometry.triangles_of(shell.name)
        sides, of, areas = _sides(geometry.triangles[own], geometry.areas[own])
        long = edge_lengths(geometry.nodes, sides)
        nodes.append(sides)
        lengths.append(long)
        radii.append(0.5 * _means(of, areas, np.repeat(thickness[own], 3)))
        weights.append(np.bincount(of, weights=areas) / long)
        loads.append(pull * _means(of, areas, np.repeat(weight[own], 3)))
        bodies.append(np.full(len(sides), key))
    ends, all_lengths, strips = np.concatenate(nodes), np.concatenate(lengths), np.concatenate(weights)
    pulls = _pulls(scene, float(all_lengths.sum()))
    mass = nodal_mass(geometry, len(structure.positions), structure.payload)
    # the lines of a shell that meet at a node stop it together
    rods_end = len(geometry.edges)
    meeting = np.maximum(np.bincount(ends[rods_end:].reshape(-1), minlength=len(mass)), 1)
    masses = np.concatenate((mass[ends[:rods_end]], (mass / meeting)[ends[rods_end:]])).sum(axis=1)
    return Lines(
        ends,
        all_lengths,
        reach * np.concatenate(radii),
        strips,
        masses,
        np.concatenate(loads) + pulls / strips,
        np.concatenate(bodies),
        names,
    )


def _sides(triangles: IntArray, areas: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Edges of a shell, each once; of each side of a triangle its edge, and its share of the area [m^2]."""
    halves = np.sort(half_edges(triangles), axis=1)
    sides, of = np.unique(halves, axis=0, return_inverse=True)
    return sides, of.reshape(-1), np.repeat(areas / 3.0, 3)


def _means(of: IntArray, areas: FloatArray, values: FloatArray) -> FloatArray:
    """Means of values of sides of triangles over the edges that they are of, by area."""
    means: FloatArray = np.bincount(of, weights=areas * values) / np.bincount(of, weights=areas)
    return means


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
