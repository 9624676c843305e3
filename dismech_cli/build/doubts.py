"""What a mesh makes doubtful: said by ``dismech check`` and before a run."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import FloatArray, IntArray
from ..scenario.load import LoadedScenario
from .geometry import Geometry
from .shell_bending import bending_of

# 0 on equilateral nets, whatever their rims; 8 on unstructured ones, 10 on discs, 21 on right angles.
_UNEVEN = 6.0


def mesh_doubts(loaded: LoadedScenario, geometry: Geometry) -> Iterator[str]:
    """Warnings, each with its place in the scenario."""
    for key, shell in zip(geometry.shell_keys, geometry.shells, strict=True):
        if bending_of(shell).converges:
            continue
        off = unevenness(geometry.nodes, geometry.triangles[geometry.triangles_of(shell.name)])
        if off > _UNEVEN:
            yield loaded.warning(
                ("geometry", key, "bending"),
                f"the corners of '{shell.name}' are {off:.0f} degrees off those of equilateral triangles: "
                f"bending '{shell.bending}' depends on the mesh there and does not converge; take 'midedge'",
            )


def unevenness(nodes: FloatArray, triangles: IntArray) -> float:
    """How far the corners of the typical triangle are from 60 degrees [deg].

    The median over triangles, so that the halved ones at the rim of an equilateral net do not
    count, of the root mean square over corners.
    """
    x = [nodes[triangles[:, k]] for k in range(3)]
    angles = []
    for k in range(3):
        a, b = x[k - 2] - x[k], x[k - 1] - x[k]
        angles.append(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))
    square = ((np.degrees(np.stack(angles)) - 60.0) ** 2).mean(axis=0)
    return float(np.median(np.sqrt(square)))
