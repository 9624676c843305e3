"""How far lines may move, pair by pair: what :mod:`.advance` does in batches."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...geometry.kernel import loop
from ...geometry.vectors import sub
from ..pieces.face_loops import MOST_PIECES, PAIR_ROWS, cut_distance, lay_pair
from ..pieces.line_loops import closing, node, segment_distance
from .advance import LEFT, ROUNDS


@loop
def _put_on_way(
    x: FloatArray, way: FloatArray, nodes: IntArray, k: int, part: float, places: FloatArray
) -> None:
    """Where the nodes of a pair are at a part of the way."""
    for i in range(nodes.shape[1]):
        for a in range(3):
            places[i, a] = x[nodes[k, i], a] + part * way[nodes[k, i], a]


@loop
def safe_way(x: FloatArray, way: FloatArray, nodes: IntArray, stop: FloatArray, nearest: FloatArray) -> float:
    """Part in (0, 1] of a way on which no line comes too near; see :func:`.advance.longest_way`.

    Args:
        x: Nodes [m], shape (N, 3).
        way: Of each [m], shape (N, 3).
        nodes: Of lines and segments, shape (P, 4), or of lines and triangles, shape (P, 5).
        stop: Gaps are what distances are more than this [m], shape (P,).
        nearest: Least gap [m], shape (P,).
    """
    places, own = np.empty((5, 3)), np.empty((1, 5), dtype=np.int64)
    for i in range(5):
        own[0, i] = i
    pair, cuts, pieces = np.empty((PAIR_ROWS, 3)), np.empty(11), np.empty((MOST_PIECES, 9))
    longest = 1.0
    for k in range(len(nodes)):
        speed = closing(way, nodes, k)
        part, least, enough = 0.0, 0.0, 0.0
        for rounds in range(ROUNDS):
            _put_on_way(x, way, nodes, k, part, places)
            if nodes.shape[1] == 5:
                lay_pair(places, own, 0, pair)
                gap = cut_distance(pair, cuts, pieces) - stop[k]
            else:
                start, first = node(places, 0), node(places, 2)
                slope, u = sub(node(places, 1), start), sub(node(places, 3), first)
                gap = segment_distance(start, slope, first, u) - stop[k]
            if rounds == 0:
                least = min(nearest[k], 0.5 * gap)
                enough = LEFT * (gap - least)
                # what is inside cannot be kept out any more
                if gap <= 0.0 or speed * longest <= gap - least:
                    part = longest
                    break
            elif gap - least <= enough:
                break
            part += (gap - least) / speed
            if part >= longest:
                break
        longest = min(longest, part)
    return longest
