"""A floor that nothing shows of but the shadows on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..arrays import FloatArray
from .actors import PartActor
from .framing import Framing
from .window import Window

_RESOLUTION = 256
_SHADE = (28, 34, 44)
_DARKNESS = 0.34
_SOFT = 0.022  # of the side of the map
_ROOM = 0.10  # around the shadow, so that it fades inside the map


class Floor:
    """The shadow of all parts on the plane z = floor, soft and moving with them."""

    def __init__(self, framing: Framing, origin: FloatArray, plotter: Any) -> None:
        """Lay it.

        Args:
            framing: The camera, over whose left shoulder the light comes.
            origin: What positions on the stage are relative to [m].
            plotter: The stage.
        """
        import pyvista as pv

        self._height = framing.floor - origin[2] - 1e-3 * framing.half_height
        self._slope = _light(framing.basis)
        self._window = Window((_RESOLUTION, _RESOLUTION), (0, 0, 0), oversampling=1)
        self._shadows: list[Any] = []
        corners: Any = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
        points: Any = np.zeros((4, 3), dtype=np.float32)
        self._plane: Any = pv.PolyData.from_regular_faces(points, np.array([[0, 1, 2], [0, 2, 3]]))
        self._plane.active_texture_coordinates = corners
        texture: Any = pv.Texture
        self._make_texture = texture
        self._texture: Any = self._make_texture(np.zeros((_RESOLUTION, _RESOLUTION, 4), dtype=np.uint8))
        self._texture.SetInterpolate(True)
        plotter.add_mesh(self._plane, texture=self._texture, lighting=False)

    def cast(self, actors: Sequence[PartActor]) -> None:
        """Cast the shadows of parts where they are now."""
        import pyvista as pv
        from scipy.ndimage import gaussian_filter

        if not self._shadows:
            for actor in actors:
                shadow: Any = pv.PolyData()
                shadow.copy_from(actor.surface)
                self._window.plotter.add_mesh(shadow, color="white", lighting=False)
                self._shadows.append(shadow)
        lower, upper = np.full(2, np.inf), np.full(2, -np.inf)
        for actor, shadow in zip(actors, self._shadows, strict=True):
            points = np.asarray(actor.surface.points)
            flat = points[:, :2] - (points[:, 2:] - self._height) * self._slope
            lower, upper = np.minimum(lower, flat.min(axis=0)), np.maximum(upper, flat.max(axis=0))
            shadow.points = np.column_stack((flat, np.zeros(len(flat), dtype=np.float32)))
        middle = (lower + upper) / 2
        half = (0.5 + _ROOM) * float((upper - lower).max())
        self._window.aim(np.eye(3), np.array([*middle, 0.0]), half, 1.0, 0.9)
        part, (rows, columns) = self._window.shoot()
        mask = np.zeros((_RESOLUTION, _RESOLUTION), dtype=np.float32)
        mask[rows, columns] = part[..., 3] > 0
        soft = gaussian_filter(mask, _SOFT * _RESOLUTION)
        image = np.zeros((_RESOLUTION, _RESOLUTION, 4), dtype=np.uint8)
        image[..., :3] = _SHADE
        image[..., 3] = (255 * _DARKNESS * soft).astype(np.uint8)
        self._texture.SetInputData(self._make_texture(image).to_image())
        x, y = np.stack((middle - half, middle + half), axis=1)
        corners = np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
        self._plane.points = np.column_stack((corners, np.full(4, self._height))).astype(np.float32)

    def close(self) -> None:
        """Let go of the graphics library."""
        self._window.close()


def _light(basis: FloatArray) -> FloatArray:
    """How far a shadow falls to the side for each unit of height, shape (2,).

    The light comes from above, and from the left and the front of whoever looks.
    """
    right, _, towards = basis
    level = -0.35 * right + 0.25 * towards
    return np.asarray(level[:2], dtype=np.float32)
