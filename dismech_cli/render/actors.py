"""Parts on the stage of VTK."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray
from .coloring import Colors
from .parts import Part

_MESH_COLOR, _MESH_OPACITY = "#101820", 0.3
_MATERIAL = {
    "ambient": 0.42,
    "diffuse": 0.66,
    "specular": 0.22,
    "specular_power": 30.0,
}


class PartActor:
    """One part; positions are told relative to an origin, so that single precision is enough for them."""

    def __init__(self, part: Part, origin: FloatArray, *, smooth: bool, mesh: bool) -> None:
        import pyvista as pv

        self.part = part
        self._origin = origin
        faces: Any = part.faces
        points: Any = np.zeros((len(part.source), 3), dtype=np.float32)
        self.surface: Any = pv.PolyData.from_regular_faces(points, faces)
        self.surface["rgb"] = np.zeros((len(points), 3), dtype=np.uint8)
        self.surface.point_data.active_normals = points + np.array([0, 0, 1], dtype=np.float32)
        self._torn = False
        self._style: dict[str, Any] = {"interpolation": "Phong" if smooth else "Flat", **_MATERIAL}
        self._mesh = mesh and part.meshed

    def add_to(self, plotter: Any) -> Any:
        """Put it on the stage; returns VTK's actor."""
        # Surfaces are closed: hiding what is turned away halves the work, and thin shells do not flicker.
        actor = plotter.add_mesh(
            self.surface,
            scalars="rgb",
            rgb=True,
            culling="back",
            show_edges=self._mesh,
            edge_color=_MESH_COLOR,
            edge_opacity=_MESH_OPACITY,
        )
        for name, value in self._style.items():
            setattr(actor.prop, name, value)
        return actor

    def move(self, t: float, positions: FloatArray) -> None:
        """Place it."""
        vertices, normals = self.part.place(t, positions)
        vertices = (vertices - self._origin).astype(np.float32)
        finite = np.asarray(np.isfinite(vertices).all(axis=1))
        if not finite.all() or self._torn:
            # what a failed run left is cut out
            self._torn = not finite.all()
            faces: Any = self.part.faces[finite[self.part.faces].all(axis=1)]
            self.surface.regular_faces = faces if len(faces) else self.part.faces[:1] * 0
            vertices[~finite] = 0.0
            normals = np.nan_to_num(normals)
        self.surface.points = vertices
        self.surface.point_data.active_normals = normals.astype(np.float32)

    def paint(self, colors: Colors) -> None:
        """Give each vertex a colour, shape (V, 3)."""
        self.surface["rgb"] = colors
