"""Weight and buoyancy as nodal forces."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..model.dofs import DofMap


def weight(dofs: DofMap, nodal_mass: FloatArray, acceleration: FloatArray) -> FloatArray:
    """Weight m g on each node.

    Args:
        dofs: Numbering.
        nodal_mass: Mass of each node [kg], shape (n_nodes,).
        acceleration: g [m/s^2], shape (3,).

    Returns:
        Generalised force [N], shape (n,).
    """
    force = np.zeros(dofs.n)
    force[: dofs.n_positions] = np.outer(nodal_mass, dofs.project(acceleration)).reshape(-1)
    return force


def buoyancy(
    dofs: DofMap, nodal_volume: FloatArray, fluid_density: float, acceleration: FloatArray
) -> FloatArray:
    """Archimedes' lift -rho_f V g on each node, with the rest volume.

    Args:
        dofs: Numbering.
        nodal_volume: Displaced volume of each node [m^3], shape (n_nodes,).
        fluid_density: rho_f [kg/m^3].
        acceleration: g [m/s^2], shape (3,).

    Returns:
        Generalised force [N], shape (n,).
    """
    return -weight(dofs, fluid_density * nodal_volume, acceleration)
