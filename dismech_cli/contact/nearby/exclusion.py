"""Lines of one body that are too near along it to touch each other.

A rod bent as tightly as it can, to its own radius, comes back to itself after half a circle of its
centreline: lines nearer than that along the body are kept apart by bending, not by contact.
"""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray, distinct


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
    order = np.argsort(nodes.ravel(), kind="stable")
    degree = np.bincount(nodes.ravel(), minlength=count)
    start, at = np.cumsum(degree) - degree, order // 2
    # ways from each line outwards, all one line longer in each round: where they are, how far, come by what
    line, here = np.repeat(np.arange(lines), 2), nodes.ravel()
    far, last = np.zeros(2 * lines), line
    found: list[IntArray] = []
    many = 2 * len(line)
    while len(line):
        ways = degree[here]
        way = np.repeat(np.arange(len(line)), ways)
        other = at[start[here][way] + np.arange(len(way)) - np.repeat(np.cumsum(ways) - ways, ways)]
        on = far[way] < 0.5 * np.pi * (radii[line[way]] + radii[other])
        # no way turns back, which is never shorter
        on &= other != last[way]
        way, other = way[on], other[on]
        line, far, last = line[way], far[way] + lengths[other], other
        found.append((line * lines + other)[other > line])
        here = nodes[other].sum(axis=1) - here[way]
        if len(line) > many:
            line, here, far, last = _shortest(line, here, far, last, count)
            many = 2 * len(line)
    return distinct(np.concatenate(found)) if found else np.empty(0, dtype=np.int64)


def _shortest(
    line: IntArray, here: IntArray, far: FloatArray, last: IntArray, count: int
) -> tuple[IntArray, IntArray, FloatArray, IntArray]:
    """Of ways from one line that meet at a node the shortest."""
    order = np.lexsort((far, line * count + here))
    line, here, far, last = line[order], here[order], far[order], last[order]
    first = np.ones(len(line), dtype=np.bool_)
    first[1:] = (line[1:] != line[:-1]) | (here[1:] != here[:-1])
    return line[first], here[first], far[first], last[first]
