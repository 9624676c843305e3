"""Joints of the scenario: nodes that become one, and what passes through them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np

from ...arrays import BoolArray, IntArray
from ...scenario.language.joint import HingeJoint
from ...scenario.load import LoadedScenario
from ...scenario.values.selection import Selects
from .contradictions import Loose, refuse_contradictions
from .geometry import Geometry, ShellWeld
from .joined import joined_by_file, joined_by_name, released_within
from .named import Apart, Pair, named_pairs, shortest_edge
from .seams import find_seams
from .selection import select_all
from .turning import RELEASED, Said, make_turning


def weld_joints(loaded: LoadedScenario, geometry: Geometry) -> Geometry:
    """Merge the nodes of joints, and those that a shell shares with other bodies of its file.

    Raises:
        ScenarioError: A joint selects no single node, its two nodes do not coincide, it is rigid and
            one is on a shell but the other is on no rod, it finds none, or it says the opposite of another.
    """
    shared = _shared_by_file(geometry)
    selected = select_all(loaded, geometry, Selects.JOINED)[Selects.JOINED]
    apart = Apart(loaded, geometry, selected, shortest_edge(geometry))
    pairs = tuple(named_pairs(apart))
    sewn = find_seams(loaded, geometry, apart.near)
    target = np.arange(len(geometry.nodes))
    for a, b in (*shared, *sewn.pairs.tolist(), *(pair.nodes for pair in pairs)):
        target[target == target[b]] = target[a]
    on_shell = geometry.carries_shell
    rigid = [pair for pair in pairs if pair.rigid]
    among_rods = [pair for pair in rigid if not on_shell[list(pair.nodes)].any()]
    at_shells = [_shell_last(pair, on_shell) for pair in rigid if on_shell[list(pair.nodes)].any()]
    for pair in among_rods:
        if pair.footprint is not None:
            raise loaded.error(("joints", pair.joint, "footprint"), "neither node is on a shell")
    welds = [weld for pair in at_shells for weld in _shell_welds(loaded, geometry, pair)]
    loose = tuple(_loose(apart))
    said = Said(
        rigid=[pair.nodes for pair in among_rods if pair.release is None],
        linked={what: [pair.nodes for pair in among_rods if pair.release == what] for what in RELEASED},
        loose=[one.node for one in loose if one.release is None],
        loosened={what: [one.node for one in loose if one.release == what] for what in RELEASED},
        welds=[end for pair in at_shells for end in _ends_at(geometry, pair.nodes[0])],
    )
    refuse_contradictions(loaded, geometry, said, pairs, loose)
    turning = make_turning(len(geometry.nodes), geometry.edges, said)
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
    joined = (
        *joined_by_file(geometry, shared),
        *joined_by_name(apart, turning, pairs, welds),
        *released_within(geometry, loose),
    )
    return replace(
        geometry,
        nodes=geometry.nodes[kept],
        edges=edges,
        triangles=triangles,
        node_groups=moved(geometry.node_groups),
        body_nodes=moved(geometry.body_nodes),
        turning=turning,
        shell_welds=tuple(replace(weld, node=int(index_of[weld.node])) for weld in welds),
        seams=tuple(replace(seam, sides=index_of[seam.sides]) for seam in sewn.welded),
        joined=tuple(replace(one, node=int(index_of[one.node])) for one in joined),
        notes=(*geometry.notes, *sewn.notes),
    )


def _loose(apart: Apart) -> Iterator[Loose]:
    """The nodes that hinges release within rods."""
    for index, joint in enumerate(apart.loaded.scenario.joints):
        if isinstance(joint, HingeJoint) and joint.where is not None:
            yield Loose(index, apart.node("joints", index, "where"), joint.release)


def _shell_last(pair: Pair, on_shell: BoolArray) -> Pair:
    """A pair with the node that is on a shell last."""
    a, b = pair.nodes
    return replace(pair, nodes=(b, a)) if on_shell[a] else pair


def _ends_at(geometry: Geometry, node: int) -> Iterator[tuple[int, int]]:
    """Edges at a node, and which of their ends is there."""
    edges, sides = np.nonzero(geometry.edges == node)
    return zip(edges.tolist(), sides.tolist(), strict=True)


def _shell_welds(loaded: LoadedScenario, geometry: Geometry, pair: Pair) -> list[ShellWeld]:
    """The edges of a rod at the first node, which turn with the shell at the second.

    Within a rod there are two. Each bends and twists over its half, as two springs in a row do: with a
    shell that gives way between them they are the rod's own joint.
    """
    path, (rod, shell) = ("joints", pair.joint), pair.nodes
    edges = [edge for edge, _ in _ends_at(geometry, rod)]
    if not edges:
        raise loaded.error(
            (*path, "nodes"),
            "a rigid joint welds rods, or a rod to a shell; two shells are welded along a 'seam'",
        )
    if len(edges) > 1 and pair.release is not None:
        raise loaded.error(
            (*path, "release"),
            f"{len(edges)} edges of a rod meet here, between which {pair.release} must pass; "
            "only its end may be released from a shell",
        )
    welds = []
    for edge in edges:
        radius = float(geometry.per_edge("radius")[edge])
        reach = radius if pair.footprint is None else pair.footprint
        welds.append(ShellWeld(edge, shell, pair.joint, pair.release, reach))
    return welds


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
