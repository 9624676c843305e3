"""Numbering of the DOFs of a scene, and its rest configuration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray
from ...kinematics.dofs import DofMap
from ..bodies.geometry import Geometry
from ..shells.topology import ShellEdges
from .plan import Bending, Plan
from .skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class Numbering:
    """DOFs and their values at rest.

    Attributes:
        dofs: Numbering.
        rest: Rest configuration q, shape (n,).
    """

    dofs: DofMap
    rest: FloatArray


def number_dofs(geometry: Geometry, plan: Plan, skeleton: Skeleton, free: ShellEdges) -> Numbering:
    """Give DOFs to the nodes, to the edges of framed rods, and to free mid-edge normals."""
    n_angles = len(skeleton.edges) if plan.bending is Bending.FRAMED else 0
    hidden = [axis for axis in range(3) if axis not in plan.axes]
    level = float(geometry.nodes[0, hidden[0]]) if hidden else 0.0
    dofs = DofMap(len(skeleton.positions), n_angles, plan.axes, len(geometry.nodes), level, len(free.edges))
    rest = np.zeros(dofs.n)
    rest[: dofs.n_positions] = dofs.project(skeleton.positions).reshape(-1)
    return Numbering(dofs, rest)
