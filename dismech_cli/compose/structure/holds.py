"""What the scenario's motions hold, in nodes and edges: known before the model is numbered."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf
from typing import assert_never

import numpy as np

from ...arrays import IntArray
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


@dataclass(frozen=True, slots=True, kw_only=True)
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
    return tuple(_hold(scene, index, motion) for index, motion in enumerate(scene.scenario.motions))


def drives(hold: Hold) -> bool:
    """Whether a hold moves or turns what it holds."""
    return hold.path.drives or not vanishes(hold.twist)


def twists(hold: Hold) -> bool:
    """Whether a hold turns edges."""
    turned = hold.path.turning is not None and bool(hold.edges.size or hold.walls.size or hold.hubs.size)
    return turned or not vanishes(hold.twist)


def _hold(scene: Scene, index: int, motion: Motion) -> Hold:
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
            hold = _at_edges(hold, scene.geometry) if at_edges else _at_nodes(hold, scene, index)
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


def _at_edges(hold: Hold, geometry: Geometry) -> Hold:
    """A clamp of edges: a lone node takes the next along its rod with it, the peers' two-node clamp."""
    lonely = np.setdiff1d(hold.nodes, geometry.edges[_inside(hold, geometry)])
    beside = np.flatnonzero(np.isin(geometry.edges, lonely).any(axis=1))
    hold = replace(hold, nodes=np.union1d(hold.nodes, geometry.edges[beside]))
    return replace(hold, edges=_inside(hold, geometry), sloped=hold.nodes)


def _at_nodes(hold: Hold, scene: Scene, index: int) -> Hold:
    """A clamp at its nodes: behind a lone rod end stands a wall."""
    geometry = scene.geometry
    inside = _inside(hold, geometry)
    lonely = np.setdiff1d(hold.nodes, geometry.edges[inside])
    # at a shell a rod is hinged: its direction stays free
    lonely = np.setdiff1d(lonely, geometry.on_shell)
    degree = np.bincount(geometry.edges.reshape(-1), minlength=len(geometry.nodes))
    hubs, ends = hubs_of(geometry), geometry.turning.ends
    at_hub = degree[lonely] > 2
    at_hub[at_hub] = [len(np.unique(ends[geometry.edges == node])) == 1 for node in lonely[at_hub]]
    crowded = lonely[(degree[lonely] != 1) & ~at_hub]
    if crowded.size:
        raise scene.error(
            ("motions", index, "where"),
            f"node {crowded[0]} is no rod end: a clamp at a node inside a rod needs its "
            "neighbour selected too, or 'at: edge'",
        )
    turned = np.concatenate((ends[inside].reshape(-1), ends[np.isin(geometry.edges, lonely[at_hub])]))
    turned = np.intersect1d(turned, hubs)
    if turned.size and not vanishes(hold.twist):
        raise scene.error(
            ("motions", index, "twist"), "turns a joint of three edges and more, which has no one axis"
        )
    return replace(hold, edges=inside, walls=lonely[~at_hub], hubs=turned, rigid=inside, sloped=hold.nodes)


def _inside(hold: Hold, geometry: Geometry) -> IntArray:
    """Edges with both nodes held."""
    return np.flatnonzero(np.isin(geometry.edges, hold.nodes).all(axis=1))
