"""Lumped mass: half of each edge and a third of each triangle to its nodes, polar inertia to angles."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kinematics.dofs import DofMap
from ..mesh.measure import nodal_areas, nodal_lengths


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
    mass = np.zeros(dofs.n)
    nodal = nodal_lengths(dofs.n_nodes, edges, lengths * per_length)
    mass[: dofs.n_positions] = np.repeat(nodal, dofs.dimension)
    # Walls behind clamps and frames of joints, whose angles come last, weigh nothing.
    turning = min(dofs.n_angles, len(edges))
    mass[dofs.n_positions : dofs.n_positions + turning] = (lengths * polar)[:turning]
    return mass


def shell_mass(dofs: DofMap, triangles: IntArray, areas: FloatArray, per_area: FloatArray) -> FloatArray:
    """Diagonal of the mass matrix, shape (n,): a third of each triangle at its corners.

    Args:
        dofs: Numbering.
        triangles: Shape (T, 3).
        areas: Rest areas [m^2], shape (T,).
        per_area: Mass per area rho h [kg/m^2], shape (T,).
    """
    mass = np.zeros(dofs.n)
    nodal = nodal_areas(dofs.n_nodes, triangles, areas * per_area)
    mass[: dofs.n_positions] = np.repeat(nodal, dofs.dimension)
    return mass
