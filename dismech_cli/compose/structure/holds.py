"""What the scenario's motions hold, in nodes and edges: known before the model is numbered."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import assert_never

import numpy as np

from ...arrays import IntArray
from ...laws.laws import Constant, Law
from ...scenario.language.motion import Clamp, Pin, Symmetry, Twist
from ...scenario.load import LoadedScenario
from ..bodies.geometry import Geometry
from ..bodies.selection import select_edges, select_nodes
from ..laws import ToLaw, components, vanishes
from ..shells.bending import bending_of

ZERO = Constant(0.0)
AXES = "xyz"
# Nodes of a plane of symmetry lie in it to this fraction of the size of the scene.
_FLAT = 1e-9


@dataclass(frozen=True, slots=True)
class Hold:
    """One motion, resolved.

    Attributes:
        name: For messages.
        nodes: Nodes whose position is held, shape (K,).
        axes: Held space components.
        displacement: One law per space axis.
        edges: Edges whose angle is held.
        twist: Law of the angle.
        walls: Nodes of ``nodes`` where a wall edge continues the rod: clamps at a single node.
        rigid: Edges that are rigid because both their nodes are clamped at the node: only the
            free half of a joint next to them bends.
        sloped: Nodes between which the normals of shell edges are held too: those of a clamp or of a
            plane of symmetry.
        release: Time [s] of release.
    """

    name: str
    nodes: IntArray
    axes: tuple[int, ...]
    displacement: tuple[Law, Law, Law]
    edges: IntArray
    twist: Law
    walls: IntArray
    rigid: IntArray
    sloped: IntArray
    release: float


_NONE = np.empty(0, dtype=np.int64)


def resolve_holds(loaded: LoadedScenario, geometry: Geometry, laws: ToLaw) -> tuple[Hold, ...]:
    """Resolve all motions of the scenario.

    Raises:
        ScenarioError: A selection is empty, a clamp at a node has no single rod end, or a plane of
            symmetry is not flat or holds what has no mid-edge normals.
    """
    holds = []
    for index, motion in enumerate(loaded.scenario.motions):
        path = ("motions", index, "where")
        name = f"motions[{index}]"
        release = inf if motion.release is None else motion.release
        match motion:
            case Symmetry():
                nodes = select_nodes(loaded, geometry, motion.where, path)
                axis = _mirror_axis(loaded, geometry, motion, path, nodes)
                zeros = (ZERO, ZERO, ZERO)
                holds.append(Hold(name, nodes, (axis,), zeros, _NONE, ZERO, _NONE, _NONE, nodes, release))
            case Clamp():
                nodes = select_nodes(loaded, geometry, motion.where, path)
                displacement = _displacement(motion.displacement, laws)
                twist = ZERO if motion.twist is None else laws(motion.twist)
                hold = _clamp(loaded, geometry, motion, path, name, nodes, displacement, twist, release)
                if motion.twist is not None and not (hold.edges.size or hold.walls.size):
                    raise loaded.error(("motions", index, "twist"), "turns no edge of a rod: none is held")
                holds.append(hold)
            case Pin():
                nodes = select_nodes(loaded, geometry, motion.where, path)
                axes = tuple(AXES.index(c) for c in motion.components)
                displacement = _displacement(motion.displacement, laws)
                holds.append(Hold(name, nodes, axes, displacement, _NONE, ZERO, _NONE, _NONE, _NONE, release))
            case Twist():
                edges = select_edges(loaded, geometry, motion.where, path)
                holds.append(
                    Hold(
                        name,
                        _NONE,
                        (),
                        (ZERO, ZERO, ZERO),
                        edges,
                        laws(motion.angle),
                        _NONE,
                        _NONE,
                        _NONE,
                        release,
                    )
                )
            case _:
                assert_never(motion)
    return tuple(holds)


def twists(hold: Hold) -> bool:
    """Whether a hold turns edges."""
    return not vanishes(hold.twist)


def _displacement(specs: object, laws: ToLaw) -> tuple[Law, Law, Law]:
    if specs is None:
        return ZERO, ZERO, ZERO
    x, y, z = components(specs, laws)  # type: ignore[arg-type]
    return x, y, z


def _mirror_axis(
    loaded: LoadedScenario,
    geometry: Geometry,
    motion: Symmetry,
    path: tuple[str | int, ...],
    nodes: IntArray,
) -> int:
    """Axis across a plane of symmetry, once the nodes are found to be in one plane and on fit shells."""
    axis = AXES.index(motion.normal)
    depth = float(np.ptp(geometry.nodes[nodes, axis]))
    if depth > _FLAT * float(np.ptp(geometry.nodes, axis=0).max()):
        raise loaded.error(
            path, f"selects nodes up to {depth:.3g} m apart in {motion.normal}; a plane of symmetry is flat"
        )
    fit = [k for k, shell in enumerate(geometry.shells) if bending_of(shell).free_normals]
    others = geometry.triangles[~np.isin(geometry.triangle_shell, fit)]
    if np.isin(nodes, others).any():
        raise loaded.error(
            path, "symmetry needs mid-edge normals; with other bending, model the mirror image too"
        )
    if not np.isin(nodes, geometry.triangles).all():
        raise loaded.error(path, "selects a node of a rod; symmetry is for shells")
    return axis


def _clamp(
    loaded: LoadedScenario,
    geometry: Geometry,
    motion: Clamp,
    path: tuple[str | int, ...],
    name: str,
    nodes: IntArray,
    displacement: tuple[Law, Law, Law],
    twist: Law,
    release: float,
) -> Hold:
    axes = (0, 1, 2)
    touched = np.isin(geometry.edges, nodes)
    inside = np.flatnonzero(touched.all(axis=1))
    if motion.at == "edge":
        # a lone node takes the next one along its rod with it: the peers' two-node clamp
        lonely = np.setdiff1d(nodes, geometry.edges[inside])
        beside = np.flatnonzero(np.isin(geometry.edges, lonely).any(axis=1))
        nodes = np.union1d(nodes, geometry.edges[beside])
        edges = np.flatnonzero(np.isin(geometry.edges, nodes).all(axis=1))
        return Hold(name, nodes, axes, displacement, edges, twist, _NONE, _NONE, nodes, release)
    lonely = np.setdiff1d(nodes, geometry.edges[inside])
    # at a shell a rod is hinged: its direction stays free
    lonely = np.setdiff1d(lonely, geometry.on_shell)
    degree = np.bincount(geometry.edges.reshape(-1), minlength=len(geometry.nodes))
    crowded = lonely[degree[lonely] != 1]
    if crowded.size:
        raise loaded.error(
            path,
            f"node {crowded[0]} is no rod end: a clamp at a node inside a rod needs its "
            "neighbour selected too, or 'at: edge'",
        )
    return Hold(name, nodes, axes, displacement, inside, twist, lonely, inside, nodes, release)
