"""What every bending model of rods asks of their joints: DOFs, stiffness, natural strains."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...kinematics.dofs import DofMap
from ..bodies.geometry import Geometry
from ..bodies.turning import RELEASED
from ..scene import Scene
from ..structure.joints import Joints
from ..structure.skeleton import Skeleton


def node_dofs(dofs: DofMap, nodes: IntArray) -> IntArray:
    """DOFs of the nodes of each stencil, shape (K, m dimension)."""
    return dofs.of_nodes(nodes).reshape(len(nodes), -1)


def of_edges(geometry: Geometry, skeleton: Skeleton, name: str) -> FloatArray:
    """A property of all edges, those of walls too, shape (E + W,)."""
    per_edge = geometry.per_edge(name)
    return np.concatenate((per_edge, per_edge[skeleton.owners]))


def in_series(geometry: Geometry, skeleton: Skeleton, name: str) -> FloatArray:
    """Stiffness of each joint: the two half edges bend or twist in series; 0 where it is released."""
    j = skeleton.joints
    k = of_edges(geometry, skeleton, name)[j.pairs]
    same = k[:, 0] == k[:, 1]
    half = 0.5 * skeleton.rest_lengths[j.pairs]
    series = half.sum(axis=1) / (half / k).sum(axis=1)
    loose = j.loose[:, RELEASED.index("twist" if name == "torsional" else "bending")]
    return np.where(loose, 0.0, np.where(same, k[:, 0], series))


def natural_density(scene: Scene, joints: Joints, rod: int, name: str) -> FloatArray | None:
    """Natural strain per length that the user gives each joint of a rod, or None; shape (joints,).

    Raises:
        ScenarioError: A list has not one value per joint.
    """
    value = getattr(scene.geometry.rods[rod].natural, name)
    if value is None:
        return None
    count = joints.counts[rod]
    if isinstance(value, float):
        return np.full(max(count, 1), value)
    if len(value) != count:
        raise scene.error(
            ("geometry", scene.geometry.rod_keys[rod], "natural", name),
            f"{len(value)} values for {count} joints; expected one per joint",
        )
    # a rod of one edge has no joint but those at its ends
    return np.array(value if count else (0.0,))
