"""Numbering of the DOFs of a scene, and its rest configuration."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ...kinematics.dofs import DofMap
from ..shells.topology import ShellEdges
from .plan import Bending, Plan
from .skeleton import Skeleton


@frozen
class Numbering:
    """DOFs and their values at rest.

    Attributes:
        dofs: Numbering.
        rest: Rest configuration q, shape (n,).
    """

    dofs: DofMap
    rest: FloatArray


def number_dofs(plan: Plan, skeleton: Skeleton, shell_edges: ShellEdges) -> Numbering:
    """Give DOFs to the nodes, to the edges of framed rods, and to mid-edge normals."""
    n_angles = len(skeleton.edges) if plan.bending is Bending.FRAMED else 0
    hidden = [axis for axis in range(3) if axis not in plan.axes]
    level = float(skeleton.positions[0, hidden[0]]) if hidden else 0.0
    n_nodes, n_normals = len(skeleton.positions), shell_edges.n_normals
    dofs = DofMap(n_nodes, n_angles, plan.axes, skeleton.visible, level, n_normals)
    rest = np.zeros(dofs.n)
    rest[: dofs.n_positions] = dofs.project(skeleton.positions).reshape(-1)
    return Numbering(dofs, rest)
