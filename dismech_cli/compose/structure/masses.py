"""Masses of rods, shells and payloads on the nodes."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...kinematics.dofs import DofMap
from ...scenario.load import LoadedScenario
from ...sections.mass import nodal_lengths, rod_mass
from ...sections.shells import nodal_areas, shell_mass
from ..bodies.geometry import Geometry
from ..bodies.selection import select_nodes


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


def point_masses(loaded: LoadedScenario, geometry: Geometry, n_nodes: int) -> FloatArray:
    """Point mass of each node [kg], shape (n_nodes,).

    Raises:
        ScenarioError: A selection is empty.
    """
    out = np.zeros(n_nodes)
    for index, entry in enumerate(loaded.scenario.masses):
        out[select_nodes(loaded, geometry, entry.where, ("masses", index, "where"))] += entry.mass
    return out
