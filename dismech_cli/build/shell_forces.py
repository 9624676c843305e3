"""Forces on shells as terms of the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray, IntArray
from ..forces.aerodynamic import aerodynamic_drag
from ..forces.hydrodynamic import area_damping, hydrodynamic_drag
from ..forces.pressure import pressure
from ..forces.thrust import thrust
from ..model.dofs import DofMap
from ..model.mass import nodal_lengths
from ..model.shell import edge_lengths, nodal_areas
from ..model.term import Term
from ..scenario.force import Aerodynamic, AreaDamping, Hydrodynamic, Pressure, Thrust
from ..scenario.load import LoadedScenario
from ..scenario.selection import Selection
from .geometry import Geometry
from .inertia import nodal_mass
from .laws import ToLaw
from .selection import KeyPath, select_nodes


def shell_drag(
    name: str, force: Aerodynamic | Hydrodynamic | AreaDamping, geometry: Geometry, dofs: DofMap
) -> Term:
    """The drag of a fluid on shells."""
    wet = _selected(geometry, force.shells)
    triangles, areas = geometry.triangles[wet], geometry.areas[wet]
    match force:
        case Aerodynamic():
            return aerodynamic_drag(
                name,
                dofs,
                triangles,
                areas,
                fluid_density=force.fluid_density,
                coefficient=force.coefficient,
            )
        case Hydrodynamic():
            area = nodal_areas(dofs.n_nodes, triangles, areas)
            return hydrodynamic_drag(
                name, dofs, area, fluid_density=force.fluid_density, coefficient=force.coefficient
            )
        case AreaDamping():
            return area_damping(name, dofs, nodal_areas(dofs.n_nodes, triangles, areas), force.coefficient)


def shell_load(
    name: str, force: Pressure | Thrust, geometry: Geometry, dofs: DofMap, payload: FloatArray, laws: ToLaw
) -> Term:
    """Pressure on a shell, or its thrust.

    Args:
        name: Unique name.
        force: As in the scenario.
        geometry: The bodies.
        dofs: Numbering.
        payload: Point mass of each node [kg], shape (n_nodes,).
        laws: Laws of time from those of the scenario.
    """
    triangles = geometry.triangles[geometry.triangles_of(force.shell)]
    match force:
        case Pressure():
            return pressure(name, dofs, triangles, laws(force.pressure))
        case Thrust():
            # shared by mass, so that the thrust itself accelerates the bell without squeezing it
            mass = nodal_mass(geometry, dofs.n_nodes, payload)
            shares = np.zeros(dofs.n_nodes)
            bell = np.unique(triangles)
            shares[bell] = mass[bell]
            nodes = np.zeros((dofs.n_nodes, 3))
            nodes[: len(geometry.nodes)] = geometry.nodes
            return thrust(
                name,
                dofs,
                nodes,
                triangles,
                coefficient=force.coefficient,
                direction=np.array(force.direction),
                shares=shares,
            )


def line_lengths(
    loaded: LoadedScenario, geometry: Geometry, n_nodes: int, where: Selection, path: KeyPath
) -> FloatArray:
    """Half the length of every shell edge between selected nodes at each of its ends [m], (n_nodes,).

    Raises:
        ScenarioError: It selects no edge.
    """
    nodes = select_nodes(loaded, geometry, where, path)
    sides = np.sort(geometry.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(sides[np.isin(sides, nodes).all(axis=1)], axis=0)
    if edges.size == 0:
        raise loaded.error(path, "selects no edge of a shell")
    return nodal_lengths(n_nodes, edges, edge_lengths(geometry.nodes, edges))


def _selected(geometry: Geometry, names: Sequence[str] | None) -> IntArray:
    """Triangles of the named shells, or of all."""
    chosen = np.array([names is None or shell.name in names for shell in geometry.shells], dtype=np.bool_)
    return np.flatnonzero(chosen[geometry.triangle_shell])
