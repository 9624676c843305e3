"""Joints of the scenario: nodes that become one, and what passes through them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ...arrays import IntArray
from ...mesh.measure import edge_lengths
from ...mesh.topology.sides import half_edges
from ...scenario.language.joint import HingeJoint, RigidJoint
from ...scenario.language.seam import Seam
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from ...scenario.values.selection import Selects
from .geometry import Geometry, ShellWeld
from .seams import find_seams
from .selection import select_all
from .turning import RELEASED, Said, make_turning, turning_nodes

# Nodes of a joint must coincide to this fraction of the shortest edge.
_COINCIDENT = 1e-6


@dataclass(frozen=True, slots=True)
class _Apart:
    """The bodies before they are joined: what joints name is still two nodes, not one.

    Attributes:
        loaded: The scenario.
        geometry: The bodies.
        selected: The node that each selection of a joint finds, shape (1,).
        near: Distance [m] up to which nodes coincide.
    """

    loaded: LoadedScenario
    geometry: Geometry
    selected: Mapping[KeyPath, IntArray]
    near: float

    def node(self, *path: str | int) -> int:
        """The node that the joint selects under a key."""
        return int(self.selected[path][0])


def weld_joints(loaded: LoadedScenario, geometry: Geometry) -> Geometry:
    """Merge the nodes of joints, and those that a shell shares with other bodies of its file.

    Raises:
        ScenarioError: A joint selects no single node, its two nodes do not coincide, or it is rigid and
            one is on a shell but the other is on no rod.
    """
    target = np.arange(len(geometry.nodes))
    linked: dict[str, list[tuple[int, int]]] = {what: [] for what in RELEASED}
    loosened: dict[str, list[int]] = {what: [] for what in RELEASED}
    loose: list[tuple[int, int]] = []
    rigid: list[tuple[int, int, int]] = []
    hinged: list[tuple[int, int, int]] = []
    welds: list[ShellWeld] = []
    ends: list[tuple[int, int]] = []
    welded: list[int] = []
    for a, b in _shared_by_file(geometry):
        target[target == target[b]] = target[a]
    near = _COINCIDENT * _shortest(geometry)
    sewn = find_seams(loaded, geometry, near)
    for a, b in sewn.pairs.tolist():
        target[target == target[b]] = target[a]
    selected = select_all(loaded, geometry, Selects.JOINED)[Selects.JOINED]
    apart = _Apart(loaded, geometry, selected, near)
    for index, joint in enumerate(loaded.scenario.joints):
        path = ("joints", index)
        if isinstance(joint, Seam):
            continue
        if isinstance(joint, HingeJoint) and joint.where is not None:
            node = apart.node(*path, "where")
            loose.append((index, node))
            if joint.release is not None:
                loosened[joint.release].append(node)
            continue
        a, b = _pair(apart, index)
        target[target == target[b]] = target[a]
        if isinstance(joint, HingeJoint):
            hinged.append((index, a, b))
            continue
        on_shell = np.isin((a, b), geometry.triangles)
        if on_shell.any():
            rod, shell = (b, a) if on_shell[0] else (a, b)
            found = _shell_welds(apart, index, (rod, shell))
            ends += [(weld.edge, int(geometry.edges[weld.edge, 1] == rod)) for weld in found]
            welds += found
            welded.append(rod)
            continue
        if joint.footprint is not None:
            raise loaded.error((*path, "footprint"), "neither node is on a shell")
        rigid.append((index, a, b))
        if joint.release is not None:
            linked[joint.release].append((a, b))
    said = Said(
        rigid=[(a, b) for index, a, b in rigid if not _releases(loaded, index)],
        linked=linked,
        loose=[node for index, node in loose if not _releases(loaded, index)],
        loosened=loosened,
        welds=ends,
    )
    _refuse_contradictions(loaded, geometry, said, _Joined(rigid, hinged, loose, welded))
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
        turning=make_turning(len(geometry.nodes), geometry.edges, said),
        shell_welds=tuple(replace(weld, node=int(index_of[weld.node])) for weld in welds),
        seams=tuple(replace(seam, sides=index_of[seam.sides]) for seam in sewn.welded),
        notes=(*geometry.notes, *sewn.notes),
    )


@dataclass(frozen=True, slots=True)
class _Joined:
    """Nodes of the bodies by the number of the joint that names them.

    Attributes:
        rigid: Pairs of rods.
        hinged: Pairs.
        loose: Nodes within rods.
        welded: Nodes of rods on a shell.
    """

    rigid: list[tuple[int, int, int]]
    hinged: list[tuple[int, int, int]]
    loose: list[tuple[int, int]]
    welded: list[int]


def _releases(loaded: LoadedScenario, index: int) -> bool:
    """Whether a joint lets one of bending and twist pass."""
    joint = loaded.scenario.joints[index]
    return not isinstance(joint, Seam) and joint.release is not None


def _refuse_contradictions(loaded: LoadedScenario, geometry: Geometry, said: Said, joined: _Joined) -> None:
    """Joints that would do nothing of what they say, because others at their node say the opposite.

    Raises:
        ScenarioError: There are some.
    """
    of_node = turning_nodes(len(geometry.nodes), said)
    edges_of = np.bincount(of_node[geometry.edges].reshape(-1), minlength=len(of_node))
    loose = {int(of_node[node]): index for index, node in joined.loose if not _releases(loaded, index)}
    rigid = {int(of_node[node]): index for index, *pair in joined.rigid for node in pair}
    for index, node in joined.loose:
        if edges_of[of_node[node]] < 2:
            raise loaded.error(("joints", index), "releases nothing: only one edge of a rod ends here")
    welded = of_node[np.array(joined.welded, dtype=np.int64)]
    for index, a, b in joined.rigid:
        if np.isin(of_node[[a, b]], welded).any():
            raise loaded.error(("joints", index), "a shell joins these rods: weld each of them to it instead")
        for node in (a, b):
            if int(of_node[node]) in loose:
                raise loaded.error(
                    ("joints", index),
                    f"passes nothing but force: joints[{loose[int(of_node[node])]}] releases this node",
                )
    for index, a, b in joined.hinged:
        if of_node[a] == of_node[b]:
            raise loaded.error(
                ("joints", index),
                f"releases nothing: joints[{rigid[int(of_node[a])]}] welds these nodes",
            )


def _pair(apart: _Apart, index: int) -> tuple[int, int]:
    """The two nodes of a joint.

    Where the second selection finds the first node again, as the nearest to a point may, it means the
    one other node at that place.
    """
    path = ("joints", index, "nodes")
    nodes = apart.geometry.nodes
    a, b = apart.node(*path, 0), apart.node(*path, 1)
    if a == b:
        gaps = np.linalg.norm(nodes - nodes[a], axis=1)
        others = np.setdiff1d(np.flatnonzero(gaps <= apart.near), [a])
        if len(others) != 1:
            raise apart.loaded.error(
                path, f"both select one node, and {len(others)} others are at its place; expected one"
            )
        b = int(others[0])
    gap = float(np.linalg.norm(nodes[a] - nodes[b]))
    if gap > apart.near:
        raise apart.loaded.error(path, f"the two nodes are {gap:.3g} m apart; a joint needs them to coincide")
    return a, b


def _shell_welds(apart: _Apart, index: int, nodes: tuple[int, int]) -> list[ShellWeld]:
    """The edges of a rod at the first node, which turn with the shell at the second.

    Within a rod there are two. Each bends and twists over its half, as two springs in a row do: with a
    shell that gives way between them they are the rod's own joint.
    """
    path = ("joints", index)
    edges = np.flatnonzero((apart.geometry.edges == nodes[0]).any(axis=1))
    if len(edges) == 0:
        raise apart.loaded.error(
            (*path, "nodes"),
            "a rigid joint welds rods, or a rod to a shell; two shells are welded along a 'seam'",
        )
    joint = apart.loaded.scenario.joints[index]
    if len(edges) > 1 and isinstance(joint, RigidJoint) and joint.release is not None:
        raise apart.loaded.error(
            (*path, "release"),
            f"{len(edges)} edges of a rod meet here, between which {joint.release} must pass; "
            "only its end may be released from a shell",
        )
    return [ShellWeld(int(edge), nodes[1], index) for edge in edges]


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
        # apart where the bodies put the file in different places
        together = (geometry.nodes[first] == geometry.nodes[second]).all(axis=1)
        first, second = first[together], second[together]
        pairs += zip(first.tolist(), second.tolist(), strict=True)
    return pairs


def _shortest(geometry: Geometry) -> float:
    """Shortest rod edge or side of a triangle [m]."""
    sides = np.concatenate((geometry.edges, half_edges(geometry.triangles)))
    return float(edge_lengths(geometry.nodes, sides).min())
