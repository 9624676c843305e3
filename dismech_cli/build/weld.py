"""Joints of the scenario: nodes that become one, and what passes through them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np

from ..arrays import IntArray
from ..model.shell import edge_lengths
from ..scenario.joint import HingeJoint, RigidJoint
from ..scenario.load import LoadedScenario
from .geometry import Geometry
from .selection import select_single_node

# Nodes of a joint must coincide to this fraction of the shortest edge.
_COINCIDENT = 1e-6


def weld_joints(loaded: LoadedScenario, geometry: Geometry) -> Geometry:
    """Merge the nodes of joints, and those that a shell shares with other bodies of its file.

    Raises:
        ScenarioError: Two nodes of a joint do not coincide, or it is rigid and one is on a shell.
    """
    target = np.arange(len(geometry.nodes))
    hinges: list[int] = []
    rod_hinges: list[int] = []
    shared = _shared_by_file(geometry)
    for a, b in shared:
        target[target == target[b]] = target[a]
        rod_hinges.append(a)
    near = _COINCIDENT * _shortest(geometry)
    for index, joint in enumerate(loaded.scenario.joints):
        path = ("joints", index)
        if isinstance(joint, HingeJoint) and joint.where is not None:
            hinges.append(select_single_node(loaded, geometry, joint.where, (*path, "where")))
            continue
        assert joint.nodes is not None
        a, b = (
            select_single_node(loaded, geometry, side, (*path, "nodes", k))
            for k, side in enumerate(joint.nodes)
        )
        gap = float(np.linalg.norm(geometry.nodes[a] - geometry.nodes[b]))
        if gap > near:
            raise loaded.error(
                (*path, "nodes"), f"the two nodes are {gap:.3g} m apart; a joint needs them to coincide"
            )
        if isinstance(joint, RigidJoint) and np.isin((a, b), geometry.triangles).any():
            raise loaded.error(
                (*path, "type"), "a joint to a shell passes forces but no bending or twist; take 'hinge'"
            )
        target[target == target[b]] = target[a]
        if isinstance(joint, HingeJoint):
            rod_hinges.append(a)
    kept, index_of = np.unique(target, return_inverse=True)

    def moved(groups: Mapping[str, IntArray]) -> dict[str, IntArray]:
        return {name: index_of[group] for name, group in groups.items()}

    edges, triangles = index_of[geometry.edges], index_of[geometry.triangles]
    degenerate = np.flatnonzero(edges[:, 0] == edges[:, 1])
    if degenerate.size:
        raise loaded.error(("joints",), f"a joint welds both ends of edge {degenerate[0]} together")
    folded = np.flatnonzero((np.diff(np.sort(triangles, axis=1), axis=1) == 0).any(axis=1))
    if folded.size:
        raise loaded.error(("joints",), f"a joint welds two corners of triangle {folded[0]} together")
    return replace(
        geometry,
        nodes=geometry.nodes[kept],
        edges=edges,
        triangles=triangles,
        node_groups=moved(geometry.node_groups),
        body_nodes=moved(geometry.body_nodes),
        hinges=index_of[np.array(hinges, dtype=np.int64)],
        rod_hinges=index_of[np.array(rod_hinges, dtype=np.int64)],
    )


def _shared_by_file(geometry: Geometry) -> list[tuple[int, int]]:
    """Pairs of nodes that a shell and another body took from one place in one file.

    Rods from one file stay apart unless a joint says otherwise: only its joint knows whether
    bending passes.
    """
    shells = {shell.name for shell in geometry.shells}
    pairs: list[tuple[int, int]] = []
    for one, two in combinations(geometry.files, 2):
        (file, numbers), (other, others) = geometry.files[one], geometry.files[two]
        if file != other or not shells.intersection((one, two)):
            continue
        _, here, there = np.intersect1d(numbers, others, assume_unique=True, return_indices=True)
        first, second = geometry.body_nodes[one][here], geometry.body_nodes[two][there]
        pairs += zip(first.tolist(), second.tolist(), strict=True)
    return pairs


def _shortest(geometry: Geometry) -> float:
    """Shortest rod edge or side of a triangle [m]."""
    sides = geometry.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return float(edge_lengths(geometry.nodes, np.concatenate((geometry.edges, sides))).min())
