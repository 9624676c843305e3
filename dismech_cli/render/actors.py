"""Parts on the stage."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from .coloring import Colors
from .parts import Part
from .polydata import make_actor, surface
from .shading import shade

_MESH_COLOR, _MESH_OPACITY = (0x10 / 255, 0x18 / 255, 0x20 / 255), 0.3


class PartActor:
    """One part; positions are told relative to an origin, so that single precision is enough for them.

    Attributes:
        part: The part.
        points: Where its vertices are, shape (V, 3).
        faces: Those of its triangles that are whole, shape (F, 3).
        actor: What stands on the stage.
    """

    def __init__(self, part: Part, origin: FloatArray, *, smooth: bool, mesh: bool, parallel: bool) -> None:
        """Make it, anywhere.

        Args:
            part: The part.
            origin: What positions on the stage are relative to [m].
            smooth: Whether normals are averaged over the facets.
            mesh: Whether triangles have lines where they are those of the model.
            parallel: Whether all lines of sight are parallel.
        """
        self.part = part
        self.faces = part.faces
        self.points: NDArray[np.float32] = np.zeros((len(part.source), 3), dtype=np.float32)
        self._origin = origin
        self._surface: Any = surface(self.points, part.faces)
        self._torn = False
        self.actor: Any = make_actor(self._surface)
        shade(self.actor, smooth=smooth, parallel=parallel)
        if mesh and part.meshed:
            look = self.actor.GetProperty()
            look.EdgeVisibilityOn()
            look.SetEdgeColor(*_MESH_COLOR)
            look.SetEdgeOpacity(_MESH_OPACITY)

    def move(self, t: float, positions: FloatArray) -> None:
        """Place it."""
        vertices, normals = self.part.place(t, positions)
        self.points = (vertices - self._origin).astype(np.float32)
        finite = np.asarray(np.isfinite(self.points).all(axis=1))
        if not finite.all() or self._torn:
            # what a failed run left is cut out
            self._torn = not finite.all()
            self.faces = self.part.faces[finite[self.part.faces].all(axis=1)]
            self._surface.regular_faces = self.faces if len(self.faces) else 0 * self.part.faces[:1]
            self.points[~finite] = 0.0
            normals = np.nan_to_num(normals)
        self._surface.points = self.points
        self._surface.point_data.active_normals = normals.astype(np.float32)

    def paint(self, colors: Colors) -> None:
        """Give each vertex a colour, shape (V, 3)."""
        self._surface.point_data.set_scalars(colors, "rgb")
