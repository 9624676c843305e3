"""What the scenario's motions hold, in nodes and edges: known before the model is numbered."""

from __future__ import annotations

from dataclasses import field, replace
from math import inf
from typing import assert_never

import numpy as np

from ...arrays import IntArray, distinct, shared, union, without
from ...frozen import frozen
from ...laws.laws import Law
from ...scenario.language.motion import Clamp, Motion, Pin, Symmetry, Twist
from ..bodies.geometry import Geometry
from ..laws import vanishes
from ..scene import Scene
from ..shells.bending import bending_of
from .hubs import hub_nodes, hubs_of
from .paths import ZERO, Path, path_of

AXES = "xyz"
# Nodes of a plane of symmetry lie in it to this fraction of the size of the scene.
_FLAT = 1e-9


def _none() -> IntArray:
    return np.empty(0, dtype=np.int64)


@frozen(kw_only=True)
class Hold:
    """One motion, resolved; what it does not say it leaves alone.

    Attributes:
        name: For messages.
        nodes: Nodes whose position is held, shape (K,).
        axes: Held space components.
        path: How the nodes move, then those of the walls, as their own nodes do.
        edges: Edges whose angle is held.
        twist: Law of the angle.
        walls: Nodes of ``nodes`` where a wall edge continues the rod: clamps at a single node.
        hubs: Numbers of the ends of edges that turn as one with what is held: their stub is held too.
        rigid: Edges that are rigid because both their nodes are clamped at the node: only the
            free half of a joint next to them bends.
        sloped: Nodes between which the normals of shell edges are held too: those of a clamp or of a
            plane of symmetry.
        release: Time [s] of release.
    """

    name: str
    nodes: IntArray = field(default_factory=_none)
    axes: tuple[int, ...] = ()
    path: Path = field(default_factory=Path)
    edges: IntArray = field(default_factory=_none)
    twist: Law = ZERO
    walls: IntArray = field(default_factory=_none)
    hubs: IntArray = field(default_factory=_none)
    rigid: IntArray = field(default_factory=_none)
    sloped: IntArray = field(default_factory=_none)
    release: float = inf


def resolve_holds(scene: Scene) -> tuple[Hold, ...]:
    """Resolve all motions of the scenario.

    Raises:
        ScenarioError: A clamp at a node has no single rod end or turns nothing, or a plane of symmetry
            is not flat or holds what has no mid-edge normals.
    """
    motions = scene.scenario.motions
    if not motions:
        return ()
    around = _Around.of(scene.geometry)
    return tuple(_hold(scene, around, index, motion) for index, motion in enumerate(motions))


def drives(hold: Hold) -> bool:
    """Whether a hold moves or turns what it holds."""
    return hold.path.drives or not vanishes(hold.twist)


def twists(hold: Hold) -> bool:
    """Whether a hold turns edges."""
    turned = hold.path.turning is not None and bool(hold.edges.size or hold.walls.size or hold.hubs.size)
    return turned or not vanishes(hold.twist)


@frozen
class _Around:
    """What is at each node, found once for all motions: there may be one for each of thousands of rods.

    Attributes:
        edges: Nodes of all edges, shape (E, 2).
        starts: Where the ends at each node begin, shape (N + 1,).
        ends: Edges by the nodes at their ends, shape (2 E,).
        on_shell: Nodes of the shells.
        hubs: Numbers of the ends of edges that turn as one at each hub.
    """

    edges: IntArray
    starts: IntArray
    ends: IntArray
    on_shell: IntArray
    hubs: IntArray

    @classmethod
    def of(cls, geometry: Geometry) -> _Around:
        """Of bodies that are put together."""
        by_node = np.argsort(geometry.edges, axis=None, kind="stable")
        sorted_nodes = geometry.edges.reshape(-1)[by_node]
        starts = np.searchsorted(sorted_nodes, np.arange(len(geometry.nodes) + 1))
        return cls(geometry.edges, starts, by_node // 2, geometry.on_shell, hubs_of(geometry))

    def degree(self, nodes: IntArray) -> IntArray:
        """How many ends of edges are at each of some nodes, shape (K,)."""
        count: IntArray = self.starts[nodes + 1] - self.starts[nodes]
        return count

    def touching(self, nodes: IntArray) -> IntArray:
        """Edges with an end at one of some nodes, each once, ascending."""
        none = np.empty(0, dtype=np.int64)
        return distinct(
            np.concatenate((none, *(self.ends[self.starts[k] : self.starts[k + 1]] for k in nodes)))
        )

    def inside(self, nodes: IntArray) -> IntArray:
        """Edges with both ends at some nodes, ascending."""
        near = self.touching(nodes)
        return near[np.isin(self.edges[near], nodes).all(axis=1)]


def _hold(scene: Scene, around: _Around, index: int, motion: Motion) -> Hold:
    where = ("motions", index, "where")
    hold = Hold(name=f"motions[{index}]", release=inf if motion.release is None else motion.release)
    match motion:
        case Symmetry():
            nodes = scene.places.nodes(where)
            return replace(hold, nodes=nodes, axes=(_mirror_axis(scene, index, motion),), sloped=nodes)
        case Clamp():
            hold = replace(
                hold,
                nodes=scene.places.nodes(where),
                axes=(0, 1, 2),
                twist=ZERO if motion.twist is None else scene.laws(motion.twist),
            )
            at_edges = motion.at == "edge"
            hold = _at_edges(hold, around) if at_edges else _at_nodes(hold, scene, around, index)
            if motion.twist is not None and not (hold.edges.size or hold.walls.size):
                raise scene.error(("motions", index, "twist"), "turns no edge of a rod: none is held")
            return _moved(hold, scene, index, motion)
        case Pin():
            hold = replace(
                hold,
                nodes=scene.places.nodes(where),
                axes=tuple(AXES.index(c) for c in motion.components),
            )
            return _moved(hold, scene, index, motion)
        case Twist():
            return replace(hold, edges=scene.places.edges(where), twist=scene.laws(motion.angle))
        case _:
            assert_never(motion)


def _moved(hold: Hold, scene: Scene, index: int, motion: Clamp | Pin) -> Hold:
    """The hold with its path; walls and stubs go the way of their nodes."""
    nodes = np.concatenate((hold.nodes, np.sort(hold.walls), hub_nodes(scene.geometry, hold.hubs)))
    return replace(hold, path=path_of(scene, index, motion, nodes))


def _mirror_axis(scene: Scene, index: int, motion: Symmetry) -> int:
    """Axis across a plane of symmetry, once the nodes are found to be in one plane and on fit shells."""
    path, geometry = ("motions", index, "where"), scene.geometry
    nodes = scene.places.nodes(path)
    axis = AXES.index(motion.normal)
    depth = float(np.ptp(geometry.nodes[nodes, axis]))
    if depth > _FLAT * float(np.ptp(geometry.nodes, axis=0).max()):
        raise scene.error(
            path, f"selects nodes up to {depth:.3g} m apart in {motion.normal}; a plane of symmetry is flat"
        )
    fit = [k for k, shell in enumerate(geometry.shells) if bending_of(shell).has_normals]
    others = geometry.triangles[~np.isin(geometry.triangle_shell, fit)]
    if np.isin(nodes, others).any():
        raise scene.error(
            path, "symmetry needs mid-edge normals; with other bending, model the mirror image too"
        )
    if not np.isin(nodes, geometry.triangles).all():
        raise scene.error(path, "selects a node of a rod; symmetry is for shells")
    return axis


def _at_edges(hold: Hold, around: _Around) -> Hold:
    """A clamp of edges: a lone node takes the next along its rod with it, the peers' two-node clamp."""
    beside = around.touching(_lonely(hold, around))
    hold = replace(hold, nodes=union(hold.nodes, around.edges[beside]))
    return replace(hold, edges=around.inside(hold.nodes), sloped=hold.nodes)


def _at_nodes(hold: Hold, scene: Scene, around: _Around, index: int) -> Hold:
    """A clamp at its nodes: behind a lone rod end stands a wall."""
    inside, ends = around.inside(hold.nodes), scene.geometry.turning.ends
    # at a shell a rod is hinged: its direction stays free
    lonely = without(_lonely(hold, around), around.on_shell)
    degree = around.degree(lonely)
    at_hub = degree > 2
    at_hub[at_hub] = [len(distinct(ends[around.edges == node])) == 1 for node in lonely[at_hub]]
    crowded = lonely[(degree != 1) & ~at_hub]
    if crowded.size:
        raise scene.error(
            ("motions", index, "where"),
            f"node {crowded[0]} is no rod end: a clamp at a node inside a rod needs its "
            "neighbour selected too, or 'at: edge'",
        )
    beside = around.touching(lonely[at_hub])
    at_hubs = ends[beside][np.isin(around.edges[beside], lonely[at_hub])]
    turned = shared(np.concatenate((ends[inside].reshape(-1), at_hubs)), around.hubs)
    if turned.size and not vanishes(hold.twist):
        raise scene.error(
            ("motions", index, "twist"), "turns a joint of three edges and more, which has no one axis"
        )
    return replace(hold, edges=inside, walls=lonely[~at_hub], hubs=turned, rigid=inside, sloped=hold.nodes)


def _lonely(hold: Hold, around: _Around) -> IntArray:
    """Nodes held without a neighbour, ascending."""
    return without(hold.nodes, around.edges[around.inside(hold.nodes)])
