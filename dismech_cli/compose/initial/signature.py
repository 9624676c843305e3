"""What a state is a state of: kept with every checkpoint, so that another run may start from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..bodies.geometry import Geometry
from ..structure.structure import Structure


def signature(geometry: Geometry, structure: Structure) -> Mapping[str, NDArray[Any]]:
    """Names of the bodies, their nodes and cells at rest, and which of them carry DOFs.

    ``bodies`` are their names as bytes, a line each; ``rest`` (N, 3), ``edges`` (E, 2) and ``triangles``
    (T, 3) the geometry; ``axes`` those of the model; ``walls`` (W,) the nodes with a wall behind; ``angles``
    whether rods have frames; ``rods`` (E + W, 2) their edges, walls after them; ``joints`` (J, 2) the pairs
    of edges with a reference twist; ``normals`` (B, 2) the shell edges with a normal.
    """
    return {
        "bodies": np.frombuffer("\n".join(geometry.body_nodes).encode(), dtype=np.uint8),
        "rest": geometry.nodes,
        "edges": geometry.edges,
        "triangles": geometry.triangles,
        "axes": np.array(structure.dofs.axes),
        "walls": structure.skeleton.wall_nodes,
        "angles": np.array([structure.dofs.n_angles > 0]),
        "rods": structure.skeleton.edges,
        "joints": structure.skeleton.joints.pairs,
        "normals": structure.shell_edges.edges,
    }
