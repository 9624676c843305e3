"""Linear drag and damping of shells, proportional to area and velocity: f = -c A u on each node."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..kinematics.dofs import DofMap
from .viscous import ViscousDamping


def area_damping(name: str, dofs: DofMap, nodal_area: FloatArray, coefficient: float) -> ViscousDamping:
    """Build damping per area of shell.

    Args:
        name: Unique name.
        dofs: Numbering.
        nodal_area: Rest area of each node [m^2], shape (n_nodes,); see ``sections.shells.nodal_areas``.
        coefficient: eta [N s/m^3].
    """
    nodes = np.flatnonzero(nodal_area)
    return ViscousDamping(name, dofs.of_nodes(nodes), coefficient * nodal_area[nodes])


def hydrodynamic_drag(
    name: str, dofs: DofMap, nodal_area: FloatArray, *, fluid_density: float, coefficient: float
) -> ViscousDamping:
    """Build the linear drag f = -rho c A u of a shell in slow flow.

    Args:
        name: Unique name.
        dofs: Numbering.
        nodal_area: Rest area of each node [m^2], shape (n_nodes,).
        fluid_density: rho [kg/m^3].
        coefficient: c [m/s]: the speed at which quadratic drag of coefficient 2 would be as large.
    """
    return area_damping(name, dofs, nodal_area, fluid_density * coefficient)
