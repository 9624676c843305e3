"""Points joined to a rod."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ..mesh import Mesh
from ..validate import validate


def chain(points: FloatArray, closed: bool, where: str) -> Mesh:
    """Join consecutive points, and the last to the first if closed."""
    index = np.arange(len(points))
    edges = np.stack([index, np.roll(index, -1)], axis=1)
    if closed:
        return validate(Mesh(nodes=points, edges=edges), where)
    ends = {"start": index[:1], "end": index[-1:]}
    return validate(Mesh(nodes=points, edges=edges[:-1], node_groups=ends), where)
