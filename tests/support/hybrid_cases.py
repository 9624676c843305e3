"""A rod whose end turns with two faces, one at its node and one beside it, put together by hand."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from cases import NUMPY, UNEQUAL, framed_rod

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.energies.rod_shell import rod_shell_terms
from dismech_cli.kinematics.rod_frames import RodFrames
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy

NODES = np.array(
    [
        [-1.0, 0.2, 0.1],
        [0.0, 0.0, 0.0],
        [0.9, -0.4, 0.3],
        [0.7, 0.8, -0.2],
        [1.6, 0.5, 0.4],
    ]
)
FACES = np.array([[3, 1, 2], [2, 4, 3]])
STIFFNESS = np.array([[0.7, 0.3], [1.3, 0.5], [0.4, 0.9]])
"""Against twist and bending about m1 and m2, on either face; all different."""


@dataclass(frozen=True, slots=True)
class Hybrid:
    """The model of a rod network that the faces' corners belong to, and the terms of the weld."""

    model: Model
    on: StencilEnergy
    beside: StencilEnergy


def hybrid(toward: bool, nodes: FloatArray = NODES, faces: IntArray = FACES) -> Hybrid:
    """Build one.

    Args:
        toward: Whether the rod's edge runs to the joint or from it.
        nodes: Positions; the rod runs from 0 to 1.
        faces: Corners of the two faces, the first with node 1.
    """
    edges = np.array([[0, 1] if toward else [1, 0], [1, 2], [1, 3], [2, 4], [3, 4]])
    model = framed_rod(nodes, edges, UNEQUAL, driver=NUMPY)
    assert isinstance(model.frames, RodFrames)
    places = model.frames.director_places(np.zeros(2, dtype=np.int64))
    rest = model.frames.transport(model.frames.rest(model.rest), model.rest).auxiliary
    (on, _), (beside, _) = rod_shell_terms(
        "weld",
        model.dofs,
        nodes,
        np.array([[0, 1], [0, 1]]),
        faces,
        model.dofs.of_angles(np.zeros(2, dtype=np.int64)),
        np.full(2, 1.0 if toward else -1.0),
        rest[places].reshape(2, 2, 3).transpose(1, 0, 2),
        STIFFNESS,
        places,
    )
    return Hybrid(replace(model, terms=(*model.terms, on, beside)), on, beside)
