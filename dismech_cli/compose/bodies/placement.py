"""Where the mesh of a file goes: scaled, then turned, then moved."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ...scenario.language.geometry import MeshFile, Rotation, SurfaceFile


@frozen
class Placement:
    """Scale, turn and shift of a mesh.

    Attributes:
        scale: Metres per unit of length in the file.
        rotate: Turn of the scaled mesh, or None.
        move: Shift after that [m].
    """

    scale: float
    rotate: Rotation | None
    move: tuple[float, ...]

    def __call__(self, nodes: FloatArray) -> FloatArray:
        """The places [m] of nodes of the file, shape (N, 3).

        A node comes out the same to the last bit whatever nodes come with it, so that bodies of one
        file know the nodes that they share.
        """
        placed: FloatArray = self.scale * nodes
        if self.rotate is not None:
            placed = _turned(placed, self.rotate)
        # Adding nothing would still turn -0.0 into 0.0.
        return placed + np.array(self.move) if any(self.move) else placed


def placement_of(source: MeshFile | SurfaceFile) -> Placement:
    """As the scenario has it."""
    return Placement(source.scale, source.rotate, source.move)


def _turned(nodes: FloatArray, rotate: Rotation) -> FloatArray:
    """Rodrigues' formula, in products of numbers rather than matrices."""
    k = np.array(rotate.axis) / np.linalg.norm(rotate.axis)
    x = nodes - np.array(rotate.about)
    cosine, sine = np.cos(rotate.angle), np.sin(rotate.angle)
    along = (x[:, 0] * k[0] + x[:, 1] * k[1] + x[:, 2] * k[2])[:, None] * k
    turned: FloatArray = cosine * x + sine * np.cross(k, x) + (1.0 - cosine) * along + np.array(rotate.about)
    return turned
