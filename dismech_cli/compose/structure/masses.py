"""Masses of rods, shells and payloads on the nodes."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...kinematics.dofs import DofMap
from ...mesh.measure import nodal_areas, nodal_lengths
from ...sections.mass import rod_mass, shell_mass
from ..bodies.geometry import Geometry
from ..scene import Scene


def mass_matrix(geometry: Geometry, dofs: DofMap, payload: FloatArray) -> FloatArray:
    """Diagonal of the mass matrix, shape (n,).

    Args:
        geometry: The bodies.
        dofs: Numbering.
        payload: Point mass of each node [kg], shape (n_nodes,).
    """
    mass = rod_mass(
        dofs,
        geometry.edges,
        geometry.lengths,
        geometry.per_edge("mass_per_length"),
        geometry.per_edge("polar_per_length"),
    )
    mass += shell_mass(dofs, geometry.triangles, geometry.areas, geometry.per_triangle("mass_per_area"))
    mass[: dofs.n_positions] += np.repeat(payload, dofs.dimension)
    return mass


def nodal_mass(geometry: Geometry, n_nodes: int, payload: FloatArray) -> FloatArray:
    """Mass of each node [kg], shape (n_nodes,); the walls behind clamps weigh nothing."""
    rods = nodal_lengths(n_nodes, geometry.edges, geometry.lengths * geometry.per_edge("mass_per_length"))
    sheets = geometry.areas * geometry.per_triangle("mass_per_area")
    return rods + nodal_areas(n_nodes, geometry.triangles, sheets) + payload


def nodal_volume(geometry: Geometry, n_nodes: int) -> FloatArray:
    """Volume of each node [m^3], shape (n_nodes,)."""
    rods = nodal_lengths(n_nodes, geometry.edges, geometry.lengths * geometry.per_edge("area"))
    sheets = geometry.areas * geometry.per_triangle("thickness")
    return rods + nodal_areas(n_nodes, geometry.triangles, sheets)


def point_masses(scene: Scene, n_nodes: int) -> FloatArray:
    """Point mass of each node [kg], shape (n_nodes,)."""
    out = np.zeros(n_nodes)
    for index, entry in enumerate(scene.scenario.masses):
        out[scene.places.nodes(("masses", index, "where"))] += entry.mass
    return out
