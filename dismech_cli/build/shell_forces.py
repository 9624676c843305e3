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
from ..model.shell import nodal_areas
from ..model.term import Term
from ..scenario.force import Aerodynamic, AreaDamping, Hydrodynamic, Pressure, Thrust
from .geometry import Geometry
from .inertia import nodal_mass
from .laws import ToLaw


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


def _selected(geometry: Geometry, names: Sequence[str] | None) -> IntArray:
    """Triangles of the named shells, or of all."""
    chosen = np.array([names is None or shell.name in names for shell in geometry.shells], dtype=np.bool_)
    return np.flatnonzero(chosen[geometry.triangle_shell])
