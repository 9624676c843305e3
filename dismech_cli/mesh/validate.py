"""Is a mesh usable? Says what is wrong with which element, repairs winding, drops unused nodes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import MeshError
from .limits import MAX_COORDINATE, check_count
from .measure import area_vectors, edge_lengths, triangle_areas
from .mesh import Mesh
from .topology.components import components
from .topology.orient import reverse, reversed_triangles
from .topology.sides import half_edges, shared_sides
from .topology.weld import weld_nodes

LENGTH_TOLERANCE = 1e-12
"""Shortest edge, as a fraction of the diagonal of the bounding box."""

AREA_TOLERANCE = 1e-14
"""Smallest triangle area, as a fraction of the squared diagonal of the bounding box."""

FOLD_TOLERANCE = 1e-10
"""Neighbours are folded flat when 1 + cos(angle between normals) is below this: 1.4e-5 rad."""

# Unit vector along no edge, plane or diagonal of a regular grid.
_SKEW = np.sqrt((2.0, 3.0, 5.0)) / np.sqrt(10.0)


@dataclass(frozen=True, slots=True, kw_only=True)
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


def validate(mesh: Mesh, where: str, lines: Lines | None = None, weld: float = 0.0) -> Mesh:
    """Check a mesh and repair what can be repaired without guessing.

    Args:
        mesh: As read or generated.
        where: File or generator, for messages.
        lines: Line numbers of the file's entries, for messages.
        weld: Nodes up to this distance from each other become one; 0 leaves even those at one place.

    Returns:
        The mesh without unused nodes, consistently wound, with a note for each change and for
        several components.

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
    if weld > 0.0:
        mesh, welded = weld_nodes(mesh, weld, where)
    used = np.zeros(len(mesh.nodes), dtype=np.bool_)
    used[mesh.edges.ravel()] = True
    used[mesh.triangles.ravel()] = True
    unit = _check_nodes(mesh.nodes, used, where, lines.nodes)
    _check_edges(mesh.edges, unit, where, lines.edges)
    mesh = _check_triangles(mesh, unit, where, lines.triangles)
    # Last, so that messages count nodes as the file does.
    return _note_components(_drop_unused(mesh, used, welded))


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


def _check_nodes(nodes: FloatArray, used: BoolArray, where: str, lines: IntArray | None) -> FloatArray:
    """Return the nodes scaled by the diagonal of their bounding box, so tolerances are pure numbers.

    Unused nodes do not count and stay at the origin.
    """

    def place(node: int) -> str:
        return where if lines is None else f"{where}:{lines[node]}"

    bad = ~(np.abs(nodes) <= MAX_COORDINATE).all(axis=1) & used
    if bad.any():
        first = int(np.argmax(bad))
        raise MeshError(
            f"{place(first)}: node {first + 1} is at {nodes[first].tolist()}; "
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
    pairs = np.flatnonzero(used)[_coincident(unit[used])]
    if len(pairs):
        one, two = pairs[np.argmin(pairs[:, 1])]
        more = f" ({len(pairs) - 1} more such pairs)" if len(pairs) > 1 else ""
        raise MeshError(
            f"{place(int(two))}: node {two + 1} is at the same place as node {one + 1}; "
            f"merge them ('weld' does so) or move them apart{more}"
        )
    return unit


def _coincident(unit: FloatArray) -> IntArray:
    """Pairs (lower, higher) of coincident nodes of a mesh scaled to unit diagonal, shape (pairs, 2)."""
    order = np.lexsort(unit.T)
    same = (unit[order[1:]] == unit[order[:-1]]).all(axis=1)
    if same.any():
        # A search tree degenerates on many equal points; sorting does not.
        return np.sort(np.stack([order[:-1][same], order[1:][same]], axis=1), axis=1)

    # What lies together also lies together in its projection on any line, and nodes in general do not:
    # a sort replaces the search tree, whose import alone takes a third of a second.
    along = unit @ _SKEW
    order = np.argsort(along)
    gap = np.diff(along[order]) <= 2.0 * LENGTH_TOLERANCE
    suspects = order[np.append(gap, False) | np.insert(gap, 0, False)]
    if not suspects.size:
        return np.empty((0, 2), dtype=np.int64)

    from scipy.spatial import cKDTree

    # Two neighbours each, the node itself among them: all pairs could be very many.
    points = unit[suspects]
    distance, neighbour = cKDTree(points).query(points, k=2, distance_upper_bound=LENGTH_TOLERANCE)
    close = np.flatnonzero(np.isfinite(np.asarray(distance)[:, 1]))
    near = np.asarray(neighbour)[close]
    other = np.where(near[:, 0] == close, near[:, 1], near[:, 0])
    return np.unique(np.sort(suspects[np.stack([close, other], axis=1)], axis=1), axis=0)


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
    order = np.lexsort((away @ _SKEW, start))
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
    repeated[np.unique(np.sort(rows, axis=1), axis=0, return_index=True)[1]] = False
    return repeated


def _check_triangles(mesh: Mesh, unit: FloatArray, where: str, at: IntArray | None) -> Mesh:
    triangles = mesh.triangles
    if not len(triangles):
        return mesh
    flat = triangle_areas(unit, triangles) < AREA_TOLERANCE
    _refuse(flat, triangles, "triangle", "has zero area", where, at)
    _refuse(_repeated(triangles), triangles, "triangle", "repeats an earlier triangle", where, at)

    ordered = np.sort(half_edges(triangles), axis=1)
    pairs, inverse, counts = np.unique(ordered, axis=0, return_inverse=True, return_counts=True)
    if counts.max() > 2:
        crowded = np.asarray((counts[inverse.ravel()] > 2).reshape(-1, 3).any(axis=1))
        a, b = pairs[np.argmax(counts > 2)] + 1
        why = (
            f"meets more than one other triangle at an edge (such as nodes {a}, {b}): not a manifold surface"
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


def _note_components(mesh: Mesh) -> Mesh:
    pairs = np.concatenate([mesh.edges, mesh.triangles[:, :2], mesh.triangles[:, 1:]])
    pieces, _ = components(len(mesh.nodes), pairs)
    if pieces == 1:
        return mesh
    return replace(mesh, notes=(*mesh.notes, f"The mesh has {pieces} components that share no node."))
