"""Where two shells meet, node by node."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, distinct, shared, without
from ...frozen import frozen
from ...mesh.measure import edge_lengths
from ...mesh.topology.sides import half_edges, rim_sides
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from .geometry import Geometry

# Sides that leave a node in directions nearer than this [rad] run along each other.
_ALONG = 1e-3


@frozen
class Sheet:
    """A shell before it is joined.

    Attributes:
        name: Its name.
        number: Its place among the shells.
        nodes: Nodes that may be joined, ascending.
        rim: Its rim sides, shape (R, 2).
        sides: Keys of all its sides, see :func:`_keys`.
    """

    name: str
    number: int
    nodes: IntArray
    rim: IntArray
    sides: IntArray


def sheet_of(geometry: Geometry, name: str, where: IntArray | None) -> Sheet:
    """A shell by name, only the nodes ``where`` of which may be joined."""
    number = [shell.name for shell in geometry.shells].index(name)
    triangles = geometry.triangles[geometry.triangle_shell == number]
    nodes = distinct(triangles)
    if where is not None:
        nodes = shared(nodes, where)
    sides = distinct(_keys(geometry, half_edges(triangles)))
    return Sheet(name, number, nodes, rim_sides(triangles), sides)


def _keys(geometry: Geometry, sides: IntArray) -> IntArray:
    """One number for the two nodes of each side."""
    keys: IntArray = sides.min(axis=1) * len(geometry.nodes) + sides.max(axis=1)
    return keys


def shortest_rim(geometry: Geometry, sheets: list[Sheet]) -> float:
    """Shortest rim side [m]; without rims nothing is joined."""
    rims = np.concatenate([sheet.rim for sheet in sheets])
    return float(edge_lengths(geometry.nodes, rims).min(initial=np.inf))


def tied_nodes(
    loaded: LoadedScenario, path: KeyPath, nodes: FloatArray, sheets: tuple[Sheet, Sheet], within: float
) -> IntArray:
    """Pairs of nodes of two sheets that lie together, one of them on a rim, shape (P, 2)."""
    from scipy.spatial import cKDTree

    one, two = sheets
    if not (len(one.nodes) and len(two.nodes)):
        return np.empty((0, 2), dtype=np.int64)
    here, there = cKDTree(nodes[one.nodes]), cKDTree(nodes[two.nodes])
    close = here.sparse_distance_matrix(there, within, output_type="coo_matrix")
    pairs = np.stack((one.nodes[close.row], two.nodes[close.col]), axis=1)
    pairs = pairs[np.isin(pairs[:, 0], one.rim) | np.isin(pairs[:, 1], two.rim)]
    for side, sheet in enumerate((two, one)):
        found, counts = np.unique(pairs[:, 1 - side], return_counts=True)
        if (counts > 1).any():
            x, y, z = nodes[found[np.argmax(counts > 1)]]
            raise loaded.error(
                path,
                f"at ({x:.4g}, {y:.4g}, {z:.4g}) m several nodes of '{sheet.name}' meet one; say 'where'",
            )
    return pairs[np.lexsort(pairs.T)]


def common_sides(
    loaded: LoadedScenario, path: KeyPath, nodes: FloatArray, sheets: tuple[Sheet, Sheet], tied: IntArray
) -> IntArray:
    """Sides that both sheets have, in nodes of the first, shape (S, 2).

    Raises:
        ScenarioError: Their nodes do not match along the seam.
    """
    one, two = sheets
    first, second = np.full(len(nodes), -1), np.full(len(nodes), -1)
    first[tied[:, 1]], second[tied[:, 0]] = tied[:, 0], tied[:, 1]
    here = np.unique(np.sort(one.rim, axis=1), axis=0)
    there = np.unique(np.sort(two.rim, axis=1), axis=0)
    ours, whole = _across(here, second, two.sides, len(nodes))
    theirs, their_whole = _across(there, first, one.sides, len(nodes))
    back = first[there[theirs]]
    for sheet, sides, matched, closed in (
        (one, here, ours, whole),
        (two, there, theirs, their_whole),
    ):
        gap = closed & ~matched
        other = two if sheet is one else one
        # Across a corner that both fill, a side of one may join nodes that the other has no side between.
        if gap.any() and _hanging(nodes, sides[gap], other, tied):
            raise _mismatch(loaded, path, nodes, sides[gap][0], sheet, other)
    _check_ends(loaded, path, nodes, sheets, tied)
    return np.unique(np.sort(np.concatenate((here[ours], back)), axis=1), axis=0)


def _across(sides: IntArray, image: IntArray, known: IntArray, count: int) -> tuple[BoolArray, BoolArray]:
    """Which sides are sides of the other sheet too, and which have both ends on it."""
    ends = image[sides]
    closed = np.asarray((ends >= 0).all(axis=1))
    keys = ends.min(axis=1) * count + ends.max(axis=1)
    return closed & np.isin(keys, known), closed


def _hanging(nodes: FloatArray, sides: IntArray, other: Sheet, tied: IntArray) -> bool:
    """Whether the other sheet has a node within one of the sides."""
    inside = nodes[without(other.nodes, tied)]
    for a, b in nodes[sides]:
        along = b - a
        t = (inside - a) @ along / (along @ along)
        off = np.linalg.norm(inside - a - t[:, None] * along, axis=1)
        if ((t > 0.0) & (t < 1.0) & (off < _ALONG * np.linalg.norm(along))).any():
            return True
    return False


def _check_ends(
    loaded: LoadedScenario, path: KeyPath, nodes: FloatArray, sheets: tuple[Sheet, Sheet], tied: IntArray
) -> None:
    """Refuse rims that run on along each other from a joined node, but to nodes that are not joined."""
    one, two = sheets
    onward = [_onward(nodes, sheet, tied[:, k]) for k, sheet in enumerate(sheets)]
    place = {int(b): int(a) for a, b in tied}
    for start, direction, end in zip(*onward[1], strict=True):
        mine = onward[0][0] == place[int(start)]
        if (onward[0][1][mine] @ direction > 1.0 - 0.5 * _ALONG**2).any():
            raise _mismatch(loaded, path, nodes, np.array([start, end]), two, one)


def _onward(nodes: FloatArray, sheet: Sheet, tied: IntArray) -> tuple[IntArray, FloatArray, IntArray]:
    """Rim sides from a joined node to one that is not: start, direction, end."""
    both = np.concatenate((sheet.rim, sheet.rim[:, ::-1]))
    both = both[np.isin(both[:, 0], tied) & ~np.isin(both[:, 1], tied) & np.isin(both[:, 1], sheet.nodes)]
    directions = nodes[both[:, 1]] - nodes[both[:, 0]]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return both[:, 0], directions, both[:, 1]


def _mismatch(
    loaded: LoadedScenario, path: KeyPath, nodes: FloatArray, side: IntArray, sheet: Sheet, other: Sheet
) -> Exception:
    (a, b, c), (d, e, f) = nodes[side]
    return loaded.error(
        path,
        f"the side of '{sheet.name}' from ({a:.4g}, {b:.4g}, {c:.4g}) to ({d:.4g}, {e:.4g}, {f:.4g}) m "
        f"lies along '{other.name}', which has its nodes elsewhere; mesh both alike along the seam",
    )
