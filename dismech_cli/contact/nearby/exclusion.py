"""Lines of one body that are too near along it to touch each other.

A rod bent as tightly as it can, to its own radius, comes back to itself after half a circle of its
centreline: lines nearer than that along the body are kept apart by bending, not by contact.
"""

from __future__ import annotations

from heapq import heappop, heappush
from math import pi

import numpy as np

from ...arrays import FloatArray, IntArray


def near_along(nodes: IntArray, lengths: FloatArray, radii: FloatArray, count: int) -> IntArray:
    """Pairs of lines within half a circle of the thickness along the body, through joints too.

    Args:
        nodes: Ends, shape (E, 2); joined bodies share nodes.
        lengths: Rest lengths [m], shape (E,).
        radii: Half of the thickness [m], shape (E,).
        count: Number of nodes.

    Returns:
        Keys first times E plus second of the pairs, the lower number first, ascending.
    """
    lines = len(nodes)
    at: list[list[int]] = [[] for _ in range(count)]
    for line, (a, b) in enumerate(nodes.tolist()):
        at[a].append(line)
        at[b].append(line)
    ends, length, radius = nodes.tolist(), lengths.tolist(), radii.tolist()
    keys: set[int] = set()
    for line in range(lines):
        heap = [(0.0, node) for node in ends[line]]
        best = dict.fromkeys(ends[line], 0.0)
        while heap:
            far, node = heappop(heap)
            if far > best[node]:
                continue
            for other in at[node]:
                if far >= 0.5 * pi * (radius[line] + radius[other]):
                    continue
                if other > line:
                    keys.add(line * lines + other)
                a, b = ends[other]
                beyond, next_ = far + length[other], b if a == node else a
                if other != line and beyond < best.get(next_, np.inf):
                    best[next_] = beyond
                    heappush(heap, (beyond, next_))
    return np.array(sorted(keys), dtype=np.int64)
