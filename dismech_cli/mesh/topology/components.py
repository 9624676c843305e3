"""Connected pieces of a graph."""

from __future__ import annotations

import numpy as np

from ...arrays import IntArray

_LINE = np.array([0, 1])


def components(count: int, pairs: IntArray) -> tuple[int, IntArray]:
    """Tell which nodes hang together.

    Args:
        count: Number of nodes N.
        pairs: Nodes that are joined, shape (pairs, 2).

    Returns:
        The number of pieces, and the piece of each node, shape (N,), counted by lowest node.
    """
    if len(pairs) == count - 1 and (pairs == _LINE + np.arange(count - 1)[:, None]).all():
        # as generators number a rod, of which there may be thousands
        return 1, np.zeros(count, dtype=np.int64)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    number, label = connected_components(graph, directed=False)
    return int(number), label.astype(np.int64)
