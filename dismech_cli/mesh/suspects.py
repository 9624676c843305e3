"""Nodes that may lie together, by a sort: a search tree is needed for them alone, mostly for none."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray

SKEW = np.sqrt((2.0, 3.0, 5.0)) / np.sqrt(10.0)
"""Unit vector along no edge, plane or diagonal of a regular grid."""


def suspects(points: FloatArray, within: float) -> IntArray:
    """Points that may be as near to another as ``within``; all others are not.

    What lies together also lies together in its projection on any line, and nodes in general do not.
    The import alone of SciPy's search tree takes as long as a hundred steps of a small scene.

    Args:
        points: Positions, shape (P, 3).
        within: A distance far below those of neighbours.
    """
    along = points @ SKEW
    order = np.argsort(along)
    gap = np.diff(along[order]) <= 2.0 * within
    found: IntArray = order[np.append(gap, False) | np.insert(gap, 0, False)]
    return found
