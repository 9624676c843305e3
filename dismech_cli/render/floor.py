"""A floor that nothing shows of but the shadows on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from .actors import PartActor
from .framing import Framing
from .polydata import make_actor, surface
from .window import Window

_RESOLUTION = 256
_SHADE = (19, 29, 40)
_DARKNESS = 0.34
_SOFT = 0.022  # of the side of the map
_ROOM = 0.10  # around the shadow, so that it fades inside the map


class Floor:
    """The shadow of all parts on the plane z = floor, soft and moving with them."""

    def __init__(self, framing: Framing, origin: FloatArray, renderer: Any) -> None:
        """Lay it.

        Args:
            framing: The camera, over whose left shoulder the light comes.
            origin: What positions on the stage are relative to [m].
            renderer: The stage.
        """
        import pyvista as pv
        from vtkmodules.vtkRenderingCore import vtkTexture

        self._height = framing.floor - origin[2] - 1e-3 * framing.half_height
        self._slope = _light(framing.basis)
        self._blur = _blur(_RESOLUTION, _SOFT * _RESOLUTION)
        self._window = Window((_RESOLUTION, _RESOLUTION), (0, 0, 0), oversampling=1)
        self._shadows: list[Any] = []
        corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
        points = np.zeros((4, 3), dtype=np.float32)
        self._plane: Any = surface(points, np.array([[0, 1, 2], [0, 2, 3]]))
        self._plane.active_texture_coordinates = corners
        self._image: Any = pv.ImageData(dimensions=(_RESOLUTION, _RESOLUTION, 1))
        texture: Any = vtkTexture()
        texture.SetInputData(self._image)
        texture.InterpolateOn()
        actor = make_actor(self._plane)
        actor.SetTexture(texture)
        actor.GetProperty().LightingOff()
        # the shade is translucent whatever VTK finds in the texture of the moment
        actor.ForceTranslucentOn()
        renderer.AddActor(actor)

    def cast(self, actors: Sequence[PartActor]) -> None:
        """Cast the shadows of parts where they are now."""
        if not self._shadows:
            self._shadows = [self._shadow(actor) for actor in actors]
        lower, upper = np.full(2, np.inf), np.full(2, -np.inf)
        for actor, shadow in zip(actors, self._shadows, strict=True):
            points = actor.points
            flat = points[:, :2] - (points[:, 2:] - self._height) * self._slope
            lower, upper = np.minimum(lower, flat.min(axis=0)), np.maximum(upper, flat.max(axis=0))
            shadow.points = np.column_stack((flat, np.zeros(len(flat), dtype=np.float32)))
            if len(actor.faces) != shadow.n_cells:
                shadow.regular_faces = actor.faces
        middle = (lower + upper) / 2
        half = (0.5 + _ROOM) * float((upper - lower).max())
        self._window.aim(np.eye(3), np.array([*middle, 0.0]), half, 1.0, 0.9)
        part, (rows, columns) = self._window.shoot()
        mask = np.zeros((_RESOLUTION, _RESOLUTION), dtype=np.float32)
        mask[rows, columns] = part[..., 3] > 0
        soft = self._blur @ mask @ self._blur.T
        image = np.empty((_RESOLUTION, _RESOLUTION, 4), dtype=np.uint8)
        image[..., :3] = _SHADE
        # VTK counts rows from the foot
        image[..., 3] = (255 * _DARKNESS * soft[::-1]).astype(np.uint8)
        self._image.point_data.set_scalars(image.reshape(-1, 4), "shade")
        self._image.Modified()
        x, y = np.stack((middle - half, middle + half), axis=1)
        corners = np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
        self._plane.points = np.column_stack((corners, np.full(4, self._height))).astype(np.float32)

    def _shadow(self, actor: PartActor) -> Any:
        """The surface of a part, white whatever lights there are."""
        shadow = surface(actor.points, actor.faces)
        shown = make_actor(shadow)
        shown.GetProperty().LightingOff()
        self._window.renderer.AddActor(shown)
        return shadow

    def close(self) -> None:
        """Let go of the graphics library."""
        self._window.close()


def _blur(count: int, width: float) -> NDArray[np.float32]:
    """What blurs the columns of an image by a Gaussian of a width [pixel], shape (count, count)."""
    pixel = np.arange(count)
    bell = np.exp(-0.5 * ((pixel[:, None] - pixel) / width) ** 2)
    return np.asarray(bell / (np.sqrt(2.0 * np.pi) * width), dtype=np.float32)


def _light(basis: FloatArray) -> FloatArray:
    """How far a shadow falls to the side for each unit of height, shape (2,).

    The light comes from above, and from the left and the front of whoever looks.
    """
    right, _, towards = basis
    level = -0.35 * right + 0.25 * towards
    return np.asarray(level[:2], dtype=np.float32)
