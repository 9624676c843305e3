"""The pairs of nodes that joints name, or find, while the bodies are still apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...arrays import IntArray, without
from ...frozen import frozen
from ...mesh.measure import edge_lengths
from ...mesh.topology.sides import half_edges
from ...scenario.language.joint import AutoJoint, HingeJoint, RigidJoint
from ...scenario.language.seam import Seam
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from .geometry import Geometry

# Nodes of a joint must coincide to this fraction of the shortest edge.
_COINCIDENT = 1e-6
# Within this share of the shortest edge a node has one partner at most.
_NEAREST = 0.5


@frozen
class Apart:
    """The bodies before they are joined: what joints name is still two nodes, not one.

    Attributes:
        loaded: The scenario.
        geometry: The bodies.
        selected: The node that each selection of a joint finds, shape (1,).
        shortest: Length of the shortest edge of all bodies [m].
    """

    loaded: LoadedScenario
    geometry: Geometry
    selected: Mapping[KeyPath, IntArray]
    shortest: float

    @property
    def near(self) -> float:
        """Distance [m] up to which nodes coincide."""
        return _COINCIDENT * self.shortest

    def node(self, *path: str | int) -> int:
        """The node that the joint selects under a key."""
        return int(self.selected[path][0])


@frozen
class Pair:
    """Two nodes that become one.

    Attributes:
        joint: Place of the joint in the scenario's list.
        nodes: Its nodes, of the bodies apart.
        rigid: Whether they turn as one.
        release: What alone does not pass, or None.
        footprint: Distance [m] from the node within which triangles turn with a rod, or None.
    """

    joint: int
    nodes: tuple[int, int]
    rigid: bool
    release: str | None = None
    footprint: float | None = None


def shortest_edge(geometry: Geometry) -> float:
    """Shortest rod edge or side of a triangle [m]."""
    sides = np.concatenate((geometry.edges, half_edges(geometry.triangles)))
    return float(edge_lengths(geometry.nodes, sides).min())


def named_pairs(apart: Apart) -> Iterator[Pair]:
    """The pairs of all joints in turn.

    Raises:
        ScenarioError: A joint selects no two nodes at one place, or finds none.
    """
    joints = apart.loaded.scenario.joints
    named = {int(node) for found in apart.selected.values() for node in found}
    for index, joint in enumerate(joints):
        match joint:
            case RigidJoint():
                yield Pair(index, _two_nodes(apart, index), True, joint.release, joint.footprint)
            case HingeJoint(nodes=nodes) if nodes is not None:
                yield Pair(index, _two_nodes(apart, index), False)
            case HingeJoint() | Seam():
                pass  # within a rod nothing becomes one; sides become one elsewhere
            case AutoJoint():
                yield from _found(apart, index, joint, named)


def _two_nodes(apart: Apart, index: int) -> tuple[int, int]:
    """The two nodes of a joint.

    Where the second selection finds the first node again, as the nearest to a point may, it means the
    one other node at that place.
    """
    path = ("joints", index, "nodes")
    nodes = apart.geometry.nodes
    a, b = apart.node(*path, 0), apart.node(*path, 1)
    if a == b:
        gaps = np.linalg.norm(nodes - nodes[a], axis=1)
        others = without(np.flatnonzero(gaps <= apart.near), np.array([a]))
        if len(others) != 1:
            raise apart.loaded.error(
                path, f"both select one node, and {len(others)} others are at its place; expected one"
            )
        b = int(others[0])
    gap = float(np.linalg.norm(nodes[a] - nodes[b]))
    if gap > apart.near:
        raise apart.loaded.error(path, f"the two nodes are {gap:.3g} m apart; a joint needs them to coincide")
    return a, b


def _found(apart: Apart, index: int, joint: AutoJoint, named: set[int]) -> Iterator[Pair]:
    """Pairs of nodes of different bodies at one place."""
    from scipy.spatial import KDTree

    geometry, tolerance = apart.geometry, apart.near if joint.tolerance is None else joint.tolerance
    if tolerance > _NEAREST * apart.shortest:
        raise apart.loaded.error(
            ("joints", index, "tolerance"),
            f"is more than half of the shortest edge, {apart.shortest:.3g} m: neighbours would become one",
        )
    shells = {shell.name for shell in geometry.shells}
    order = list(geometry.body_nodes)
    wanted = [name for name in order if not joint.between or name in joint.between]
    count = 0
    for one, two in _near(geometry, wanted, tolerance):
        first, second = geometry.body_nodes[one], geometry.body_nodes[two]
        distance, partner = map(np.asarray, KDTree(geometry.nodes[first]).query(geometry.nodes[second]))
        rigid = joint.join == "rigid" if joint.join else not shells.intersection((one, two))
        for k in np.flatnonzero(distance <= tolerance):
            nodes = (int(first[partner[k]]), int(second[k]))
            count += 1
            if named.isdisjoint(nodes):
                yield Pair(index, nodes, rigid)
    if len(wanted) < 2:
        raise apart.loaded.error(("joints", index), "joins nothing: the scene has one body")
    if not count:
        raise apart.loaded.error(
            ("joints", index),
            f"joins nothing: no nodes of two bodies lie within {tolerance:.3g} m of each other; the nearest "
            f"are {_nearest(geometry, wanted):.3g} m apart",
        )


def _near(geometry: Geometry, names: list[str], reach: float) -> list[tuple[str, str]]:
    """Pairs of bodies that have nodes within reach of each other, in the order of their names."""
    from scipy.spatial import KDTree

    body = np.repeat(np.arange(len(names)), [len(geometry.body_nodes[name]) for name in names])
    nodes = np.concatenate([geometry.body_nodes[name] for name in names])
    close = KDTree(geometry.nodes[nodes]).query_pairs(reach, output_type="ndarray")
    pairs = np.unique(np.sort(body[close], axis=1), axis=0)
    return [(names[a], names[b]) for a, b in pairs if a != b]


def _nearest(geometry: Geometry, names: list[str]) -> float:
    """The least distance of nodes of different bodies [m]."""
    from scipy.spatial import KDTree

    parts = [geometry.nodes[geometry.body_nodes[name]] for name in names]
    later = [KDTree(np.concatenate(parts[k + 1 :])).query(parts[k])[0] for k in range(len(parts) - 1)]
    return min(float(np.min(distance)) for distance in later)
