"""Lumped mass of rods: half of each edge to its nodes, polar inertia to its angle."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kinematics.dofs import DofMap


def nodal_lengths(n_nodes: int, edges: IntArray, lengths: FloatArray) -> FloatArray:
    """Voronoi length of each node: half of every adjacent edge [m], shape (n_nodes,)."""
    halves = np.repeat(0.5 * lengths, 2)
    return np.bincount(edges.reshape(-1), halves, minlength=n_nodes).astype(np.float64)


def rod_mass(
    dofs: DofMap, edges: IntArray, lengths: FloatArray, per_length: FloatArray, polar: FloatArray
) -> FloatArray:
    """Diagonal of the mass matrix, shape (n,).

    Args:
        dofs: Numbering.
        edges: Rod edges, shape (E, 2).
        lengths: Rest lengths [m], shape (E,).
        per_length: Mass per length rho A [kg/m], shape (E,).
        polar: Rotary inertia per length rho (I1 + I2) [kg m], shape (E,); used where edges carry
            an angle.

    Returns:
        Nodal masses [kg] on positions, rotary inertias [kg m^2] on angles.
    """
    nodal = np.bincount(edges.reshape(-1), np.repeat(0.5 * lengths * per_length, 2), minlength=dofs.n_nodes)
    mass = np.zeros(dofs.n)
    mass[: dofs.n_positions] = np.repeat(nodal, dofs.dimension)
    # The walls behind clamps, whose angles come last, are held and weigh nothing.
    turning = min(dofs.n_angles, len(edges))
    mass[dofs.n_positions : dofs.n_positions + turning] = (lengths * polar)[:turning]
    return mass
