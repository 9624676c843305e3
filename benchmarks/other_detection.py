"""Detection of contact by ipctk, the toolkit of Incremental Potential Contact, on one thread."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from dismech_cli.arrays import FloatArray, IntArray


def detection(
    x: FloatArray, edges: IntArray, faces: IntArray, reach: float, skin: float
) -> Sequence[Callable[[], object]]:
    """Builds candidates, and collisions from these; none where ipctk is not installed.

    Args:
        x: Nodes [m], shape (N, 3).
        edges: Shape (E, 2).
        faces: Shape (T, 3).
        reach: Distance at which things touch [m].
        skin: How much farther candidates are looked for [m].
    """
    if find_spec("ipctk") is None:
        return ()
    ipctk: Any = import_module("ipctk")
    ipctk.set_num_threads(1)
    mesh = ipctk.CollisionMesh(x, edges, faces)
    phase = ipctk.LBVH() if hasattr(ipctk, "LBVH") else ipctk.HashGrid()
    candidates, collisions = ipctk.Candidates(), ipctk.NormalCollisions()

    def search() -> None:
        candidates.build(mesh, x, 0.5 * (reach + skin), phase)

    search()
    return search, lambda: collisions.build(candidates, mesh, x, reach)
