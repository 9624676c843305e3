"""Is a mesh usable? Says what is wrong with which element, repairs winding, drops unused nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, distinct
from ..errors import MeshError
from ..frozen import frozen
from .allowed import PLAIN, Allowed
from .limits import MAX_COORDINATE, check_count
from .measure import area_vectors, edge_lengths, triangle_areas
from .mesh import Mesh
from .suspects import SKEW, suspects
from .topology.components import components
from .topology.orient import reverse, reversed_triangles
from .topology.pinched import pinched_nodes
from .topology.sides import half_edges, row_keys, shared_sides, side_counts
from .topology.weld import weld_nodes

LENGTH_TOLERANCE = 1e-12
"""Shortest edge, as a fraction of the diagonal of the bounding box."""

AREA_TOLERANCE = 1e-14
"""Smallest triangle area, as a fraction of the squared diagonal of the bounding box."""

FOLD_TOLERANCE = 1e-10
"""Neighbours are folded flat when 1 + cos(angle between normals) is below this: 1.4e-5 rad."""


@frozen(kw_only=True)
class Lines:
    """Line numbers (from 1) of the entries of a mesh file; None where there are none.

    Attributes:
        nodes: Shape (N,).
        edges: Shape (E,).
        triangles: Shape (T,).
    """

    nodes: IntArray | None = None
    edges: IntArray | None = None
    triangles: IntArray | None = None


def validate(mesh: Mesh, where: str, lines: Lines | None = None, allowed: Allowed = PLAIN) -> Mesh:
    """Check a mesh and repair what can be repaired without guessing.

    Args:
        mesh: As read or generated.
        where: File or generator, for messages.
        lines: Line numbers of the file's entries, for messages.
        allowed: What it may be beyond a plain surface.

    Returns:
        The mesh without unused nodes, consistently wound, with a note for each change, for several
        components, and for slits, branches and nodes at which a surface hangs together by a point.

    Raises:
        MeshError: For indices out of range, coordinates that are not finite, duplicate nodes,
            edges or triangles, zero lengths and areas, neighbours and rods folded flat, non-manifold
            edges and surfaces that are not orientable. Elements count from 1 in messages.
    """
    lines = lines or Lines()
    for what, array in (("nodes", mesh.nodes), ("edges", mesh.edges), ("triangles", mesh.triangles)):
        check_count(len(array), what, where)
    if len(mesh.edges) + len(mesh.triangles) == 0:
        raise MeshError(f"{where}: the mesh has neither rod edges nor triangles")
    _check_range(mesh, where, lines)
    welded = np.zeros(len(mesh.nodes), dtype=np.bool_)
    if allowed.weld > 0.0:
        mesh, welded = weld_nodes(mesh, allowed.weld, where)
    used = np.zeros(len(mesh.nodes), dtype=np.bool_)
    used[mesh.edges.ravel()] = True
    used[mesh.triangles.ravel()] = True
    unit = _unit_nodes(mesh.nodes, used, where, lines.nodes)
    pairs = np.flatnonzero(used)[_coincident(unit[used])]
    if len(pairs) and not allowed.slits:
        raise _at_one_place(pairs, where, lines.nodes)
    _check_edges(mesh.edges, unit, where, lines.edges)
    mesh = _check_triangles(mesh, unit, where, lines.triangles, allowed)
    # Last, so that messages count nodes as the file does.
    return _note_connections(_drop_unused(mesh, used, welded), len(pairs))


def _refuse(bad: BoolArray, rows: IntArray, what: str, why: str, where: str, lines: IntArray | None) -> None:
    """Raise a MeshError for the first bad element, if there is one."""
    if not bad.any():
        return
    first = int(np.argmax(bad))
    place = where if lines is None else f"{where}:{lines[first]}"
    numbers = ", ".join(str(number + 1) for number in rows[first])
    others = int(bad.sum()) - 1
    tail = f" ({others} more like it)" if others else ""
    raise MeshError(f"{place}: {what} {first + 1} (nodes {numbers}) {why}{tail}")


def _check_range(mesh: Mesh, where: str, lines: Lines) -> None:
    count = len(mesh.nodes)
    for what, rows, at in (("edge", mesh.edges, lines.edges), ("triangle", mesh.triangles, lines.triangles)):
        bad = np.asarray(((rows < 0) | (rows >= count)).any(axis=1))
        _refuse(bad, rows, what, f"names a node out of range; the mesh has nodes 1 to {count}", where, at)


def _unit_nodes(nodes: FloatArray, used: BoolArray, where: str, lines: IntArray | None) -> FloatArray:
    """Return the nodes scaled by the diagonal of their bounding box, so tolerances are pure numbers.

    Unused nodes do not count and stay at the origin.
    """
    bad = ~(np.abs(nodes) <= MAX_COORDINATE).all(axis=1) & used
    if bad.any():
        first = int(np.argmax(bad))
        raise MeshError(
            f"{_place(first, where, lines)}: node {first + 1} is at {nodes[first].tolist()}; "
            f"expected finite coordinates up to {MAX_COORDINATE:g} m"
        )
    points = nodes[used]
    low = points.min(axis=0)
    diagonal = float(np.linalg.norm(points.max(axis=0) - low))
    # Where the squared diagonal underflows, no product of lengths can be trusted.
    if not diagonal > 1e-100:
        raise MeshError(f"{where}: all nodes are at the same place")
    unit = np.zeros_like(nodes)
    unit[used] = (points - low) / diagonal
    return unit


def _at_one_place(pairs: IntArray, where: str, lines: IntArray | None) -> MeshError:
    """What is wrong with pairs of coincident nodes, told of the first."""
    one, two = pairs[np.argmin(pairs[:, 1])]
    more = f" ({len(pairs) - 1} more such pairs)" if len(pairs) > 1 else ""
    return MeshError(
        f"{_place(int(two), where, lines)}: node {two + 1} is at the same place as node {one + 1}; merge "
        f"them ('weld' does so), leave them apart as the lips of a slit ('slits: open'), or move them{more}"
    )


def _place(node: int, where: str, lines: IntArray | None) -> str:
    return where if lines is None else f"{where}:{lines[node]}"


def _coincident(unit: FloatArray) -> IntArray:
    """Pairs (lower, higher) of coincident nodes of a mesh scaled to unit diagonal, shape (pairs, 2)."""
    order = np.lexsort(unit.T)
    same = (unit[order[1:]] == unit[order[:-1]]).all(axis=1)
    if same.any():
        # A search tree degenerates on many equal points; sorting does not.
        return np.sort(np.stack([order[:-1][same], order[1:][same]], axis=1), axis=1)

    asked = suspects(unit, LENGTH_TOLERANCE)
    if not asked.size:
        return np.empty((0, 2), dtype=np.int64)

    from scipy.spatial import cKDTree

    # Two neighbours each, the node itself among them: all pairs could be very many.
    points = unit[asked]
    distance, neighbour = cKDTree(points).query(points, k=2, distance_upper_bound=LENGTH_TOLERANCE)
    close = np.flatnonzero(np.isfinite(np.asarray(distance)[:, 1]))
    near = np.asarray(neighbour)[close]
    other = np.where(near[:, 0] == close, near[:, 1], near[:, 0])
    return np.unique(np.sort(asked[np.stack([close, other], axis=1)], axis=1), axis=0)


def _check_edges(edges: IntArray, unit: FloatArray, where: str, at: IntArray | None) -> None:
    if not len(edges):
        return
    _refuse(edge_lengths(unit, edges) < LENGTH_TOLERANCE, edges, "edge", "has zero length", where, at)
    _refuse(_repeated(edges), edges, "edge", "repeats an earlier edge", where, at)
    _refuse(_folded_back(edges, unit), edges, "edge", "folds straight back onto another edge", where, at)


def _folded_back(edges: IntArray, unit: FloatArray) -> BoolArray:
    """True for edges that leave a branching node as an earlier one does: the curvature there is infinite.

    Two edges alone at a node are a corner, which may be folded.
    """
    start, end = edges.T.reshape(-1), edges[:, ::-1].T.reshape(-1)
    away = unit[end] - unit[start]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    # Edges that leave a node alike also lie next to each other along a line: no need for all pairs.
    order = np.lexsort((away @ SKEW, start))
    one, two = order[:-1], order[1:]
    alike = np.einsum("ij,ij->i", away[one], away[two]) > 1.0 - FOLD_TOLERANCE
    folded = np.zeros(len(edges), dtype=np.bool_)
    branching = np.bincount(start)[start[one]] > 2
    folds = alike & branching & (start[one] == start[two])
    folded[(np.maximum(one % len(edges), two % len(edges)))[folds]] = True
    return folded


def _repeated(rows: IntArray) -> BoolArray:
    """True for rows that hold the same nodes as an earlier row."""
    repeated = np.ones(len(rows), dtype=np.bool_)
    repeated[np.unique(row_keys(rows), return_index=True)[1]] = False
    return repeated


def _check_triangles(mesh: Mesh, unit: FloatArray, where: str, at: IntArray | None, allowed: Allowed) -> Mesh:
    triangles = mesh.triangles
    if not len(triangles):
        return mesh
    flat = triangle_areas(unit, triangles) < AREA_TOLERANCE
    _refuse(flat, triangles, "triangle", "has zero area", where, at)
    _refuse(_repeated(triangles), triangles, "triangle", "repeats an earlier triangle", where, at)

    counts = side_counts(triangles)
    if counts.max() > 2 and not allowed.branches:
        crowded = np.asarray((counts > 2).reshape(-1, 3).any(axis=1))
        a, b = np.sort(half_edges(triangles)[np.argmax(counts > 2)]) + 1
        why = (
            f"meets more than one other triangle at an edge (such as nodes {a}, {b}): not a manifold "
            "surface; 'branches' says what sheets do that meet so"
        )
        _refuse(crowded, triangles, "triangle", why, where, at)

    wrong = reversed_triangles(triangles, where)
    if wrong.any():
        numbers = np.flatnonzero(wrong) + 1
        shown = ", ".join(map(str, numbers[:5])) + (", ..." if len(numbers) > 5 else "")
        note = (
            f"{len(numbers)} of {len(triangles)} triangles reversed to wind like their neighbours ({shown})."
        )
        triangles = reverse(triangles, wrong)
        mesh = replace(mesh, triangles=triangles, notes=(*mesh.notes, note))
    _check_folds(triangles, unit, where, at)
    return mesh


def _check_folds(triangles: IntArray, unit: FloatArray, where: str, at: IntArray | None) -> None:
    """Refuse neighbours lying flat on each other: their hinge angle of pi has no sign."""
    one, two = (side // 3 for side in shared_sides(triangles))
    normal = area_vectors(unit, triangles)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    flat = np.einsum("ij,ij->i", normal[one], normal[two]) < -1.0 + FOLD_TOLERANCE
    folded = np.zeros(len(triangles), dtype=np.bool_)
    folded[np.maximum(one, two)[flat]] = True
    _refuse(folded, triangles, "triangle", "is folded flat onto its neighbour", where, at)


def _drop_unused(mesh: Mesh, used: BoolArray, welded: BoolArray) -> Mesh:
    """Remove nodes without an element: they would have neither mass nor stiffness; those welded were told."""
    if used.all():
        return mesh
    index = np.cumsum(used) - 1
    dropped = np.flatnonzero(~used & ~welded)
    groups = {name: index[group[used[group]]] for name, group in mesh.node_groups.items()}
    what = "node" if len(dropped) == 1 else "nodes"
    note = (
        dropped.size
        and f"{len(dropped)} {what} without an edge or triangle dropped (first: node {dropped[0] + 1})."
    )
    return replace(
        mesh,
        nodes=mesh.nodes[used],
        edges=index[mesh.edges],
        triangles=index[mesh.triangles],
        node_groups={name: group for name, group in groups.items() if len(group)},
        notes=(*mesh.notes, note) if note else mesh.notes,
    )


def _note_connections(mesh: Mesh, coincident: int) -> Mesh:
    """Say what hangs together otherwise than sheets do, from node to node and from edge to edge."""
    notes = list(mesh.notes)
    pairs = np.concatenate([mesh.edges, mesh.triangles[:, :2], mesh.triangles[:, 1:]])
    pieces, _ = components(len(mesh.nodes), pairs)
    if pieces > 1:
        notes.append(f"The mesh has {pieces} components that share no node.")
    if coincident:
        notes.append(f"{_some(coincident, 'pair')} of nodes at the same place stay apart, as lips of slits.")
    sides = half_edges(mesh.triangles)[side_counts(mesh.triangles) > 2]
    if branching := len(distinct(row_keys(sides))):
        notes.append(f"Three or more sheets meet at {_some(branching, 'edge')}.")
    if len(mesh.triangles) and (pinched := pinched_nodes(mesh.triangles)).size:
        notes.append(
            f"Parts of the surface hang together by {_some(pinched.size, 'node')} alone, as by ball joints."
        )
    return replace(mesh, notes=tuple(notes)) if len(notes) > len(mesh.notes) else mesh


def _some(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"
