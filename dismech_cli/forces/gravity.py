"""A uniform acceleration as nodal forces: weight, and buoyancy as the weight of negative mass."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..kinematics.dofs import DofMap


def weight(dofs: DofMap, nodal_mass: FloatArray, acceleration: FloatArray) -> FloatArray:
    """Weight m g on each node.

    Args:
        dofs: Numbering.
        nodal_mass: Mass of each node [kg], shape (n_nodes,); -rho_f V for the lift of a fluid.
        acceleration: g [m/s^2], shape (3,).

    Returns:
        Generalised force [N], shape (n,).
    """
    force = np.zeros(dofs.n)
    force[: dofs.n_positions] = np.outer(nodal_mass, dofs.project(acceleration)).reshape(-1)
    return force
