"""A state of another run as one of this scene: the same bodies, perhaps held otherwise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray, IntArray
from ...errors import ScenarioError
from ...frozen import frozen
from ...geometry.rotation import orthonormal_to
from ...kinematics.rod_frames import FrameState, RodFrames
from ..bodies.geometry import Geometry
from ..structure.structure import Structure
from .known import Known
from .signature import signature

# Rest shapes are the same to this share of their size; files carry ten digits.
_SAME_PLACE = 1e-9


@frozen
class Started:
    """Where everything is at the start.

    Attributes:
        q: Positions and angles, shape (n,).
        v: Their rates, shape (n,).
        frames: Frames at ``q``.
    """

    q: FloatArray
    v: FloatArray
    frames: FrameState


def mapped(known: Known, geometry: Geometry, structure: Structure) -> Started:
    """The state in the numbering of this scene.

    Raises:
        ScenarioError: It is of other bodies, or of rods and shells with other unknowns.
    """
    _compare(known, signature(geometry, structure))
    dofs, skeleton = structure.dofs, structure.skeleton
    q, v = structure.rest.copy(), np.zeros(dofs.n)
    of_nodes = dofs.of_nodes(np.arange(skeleton.visible)).reshape(-1)
    q[of_nodes], v[of_nodes] = known.q[of_nodes], known.v[of_nodes]
    before = {behind: k for k, behind in enumerate(_counted(known.structure["walls"]))}
    for k, behind in enumerate(_counted(skeleton.wall_nodes)):
        node, here = behind[0], dofs.of_nodes(np.array(skeleton.visible + k))
        if behind in before:
            there = dofs.of_nodes(np.array(skeleton.visible + before[behind]))
            q[here], v[here] = known.q[there], known.v[there]
        else:
            (other,) = set(geometry.edges[skeleton.owners[k]].tolist()) - {node}
            ends = dofs.of_nodes(np.array([node, other]))
            q[here] = 2.0 * q[ends[0]] - q[ends[1]]
    walls = len(known.structure["walls"])
    split = dofs.dimension * (skeleton.visible + walls)
    frames = structure.frames.rest(q)
    if dofs.n_angles:
        frames = _rods(known, structure, split, before, (q, v), frames)
    if len(structure.shell_edges.edges):
        skipped = split + (len(geometry.edges) + walls if dofs.n_angles else 0)
        normals = dofs.of_normals(np.arange(structure.shell_edges.n_normals))
        if len(known.q) - skipped != len(normals):
            raise ScenarioError("is a state of shells that are welded otherwise: take the same seams")
        q[normals], v[normals] = known.q[skipped:], known.v[skipped:]
        stored = known.frames
        frames = replace(
            frames,
            edge_tangent=stored.edge_tangent,
            edge_normal=stored.edge_normal,
            edge_angle=stored.edge_angle,
        )
    return Started(q, v, frames)


def _counted(nodes: IntArray) -> list[tuple[int, int]]:
    """Nodes with walls or stubs, each with how many at it came before: two hubs may share one."""
    counts: dict[int, int] = {}
    out = []
    for node in nodes.tolist():
        out.append((node, counts.get(node, 0)))
        counts[node] = counts.get(node, 0) + 1
    return out


def _rods(
    known: Known,
    structure: Structure,
    split: int,
    before: dict[tuple[int, int], int],
    start: tuple[FloatArray, FloatArray],
    frames: FrameState,
) -> FrameState:
    """Angles of the edges and their directors; a new wall has those of its rod's end."""
    dofs, skeleton, rods = structure.dofs, structure.skeleton, structure.rod_frames
    assert isinstance(rods, RodFrames)
    edges = len(skeleton.edges) - len(skeleton.wall_nodes)
    source = [
        edges + before[behind] if behind in before else int(owner)
        for behind, owner in zip(_counted(skeleton.wall_nodes), skeleton.owners, strict=True)
    ]
    columns = np.concatenate((np.arange(edges), np.array(source, dtype=np.int64)))
    q, v = start
    angles = dofs.of_angles(np.arange(len(columns)))
    q[angles], v[angles] = known.q[split + columns], known.v[split + columns]
    tangent = frames.tangent
    director = known.frames.director[:, columns]
    if known.frames.reference_twist.size:
        twist = _reference_twists(known, structure)
    else:
        pairs, signs = skeleton.joints.pairs, skeleton.joints.signs
        twist = signs[:, 0] * q[angles[pairs[:, 0]]] - signs[:, 1] * q[angles[pairs[:, 1]]]
    director = np.stack(orthonormal_to(director, tangent))
    return replace(frames, director=director, reference_twist=rods.reference_twist(tangent, director, twist))


def _reference_twists(known: Known, structure: Structure) -> FloatArray:
    """Near those of the same pairs of edges, near zero elsewhere."""
    pairs = structure.skeleton.joints.pairs
    at = {tuple(pair): k for k, pair in enumerate(known.structure["joints"].tolist())}
    out = np.zeros(len(pairs))
    for k, pair in enumerate(pairs.tolist()):
        if tuple(pair) in at:
            out[k] = known.frames.reference_twist[at[tuple(pair)]]
    return out


def _compare(known: Known, own: Mapping[str, NDArray[Any]]) -> None:
    before = known.structure
    names = [bytes(s["bodies"]).decode().splitlines() for s in (before, own)]
    if names[0] != names[1]:
        raise ScenarioError(f"is a state of {', '.join(names[0])}, but here are {', '.join(names[1])}")
    for name, what in (("rest", "nodes"), ("edges", "edges of rods"), ("triangles", "triangles")):
        if before[name].shape != own[name].shape:
            raise ScenarioError(
                f"is a state of {len(before[name])} {what}, but here are {len(own[name])}: take the same mesh"
            )
        if name != "rest" and not np.array_equal(before[name], own[name]):
            raise ScenarioError(f"is a state of other {what}: they join other nodes")
    size = float(np.ptp(own["rest"], axis=0).max())
    off = np.linalg.norm(before["rest"] - own["rest"], axis=1)
    if off.max() > _SAME_PLACE * size:
        node = int(np.argmax(off))
        raise ScenarioError(
            f"is a state of another rest shape: node {node} rests {off[node]:.3g} m from where it does here"
        )
    if not np.array_equal(before["axes"], own["axes"]):
        raise ScenarioError("is a state of a scene of another dimension or plane")
    if bool(before["angles"][0]) != bool(own["angles"][0]):
        lacking = "that run" if own["angles"][0] else "this scenario"
        raise ScenarioError(f"the rods of {lacking} have no material frames; say 'bending: framed' there")
    if not np.array_equal(before["normals"], own["normals"]):
        raise ScenarioError("is a state of shells with other mid-edge normals: take the same 'bending'")
