"""Light that does not get into corners, estimated from the depths of the pixels.

Of a small ball around each point, the share in front of what is seen is open; on a plane it is half
(Loos and Sloan, "Volumetric obscurance", 2010; samples in opposite pairs, so that slopes count as
planes).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from .settings import Image

# Two rings of directions; pairs are opposite.
_SAMPLES = [
    (radius * np.cos(angle), radius * np.sin(angle))
    for radius, turn in ((0.35, 0.0), (0.75, np.pi / 8))
    for angle in turn + np.pi * np.arange(4) / 4
]
_STRENGTH = 0.85


def openness(depths: FloatArray, radius: int, pixel: float) -> FloatArray:
    """How much light gets to each pixel, 1 on planes and where nothing is drawn; shape as ``depths``.

    Args:
        depths: Distances from the eye, infinite where nothing is drawn, shape (rows, columns).
        radius: Of the ball [pixel].
        pixel: Width of a pixel, in the unit of the depths.
    """
    deep = np.where(np.isfinite(depths), depths, 1e30).astype(np.float32)
    padded = np.pad(deep, radius, mode="edge")
    rows, columns = deep.shape
    hidden = np.zeros_like(deep)
    for x, y in _SAMPLES:
        height = np.float32(pixel * radius * np.sqrt(1.0 - x * x - y * y))
        i, j = round(y * radius), round(x * radius)
        pair = np.zeros_like(deep)
        for a, b in ((i, j), (-i, -j)):
            there = padded[radius + a : radius + a + rows, radius + b : radius + b + columns]
            rise = (deep - there) / height
            # what rises far above the ball stands before it, and does not touch it
            pair += np.where(rise < 2.5, np.clip(rise, -1.0, 1.0), 0.0)
        hidden += np.clip(pair, 0.0, 2.0)
    share = hidden / (2.0 * len(_SAMPLES))
    return np.asarray(np.clip(1.0 - _STRENGTH * 1.6 * share, 0.0, 1.0))


def darken(picture: Image, light: FloatArray, drawn: NDArray[np.bool_]) -> Image:
    """The picture with less light where it does not get.

    Args:
        picture: Colours and opacity, shape (rows, columns, 4).
        light: Share of it in a coarser grid over the same rows and columns.
        drawn: Where there is something in that grid.
    """
    from PIL import Image as Pillow
    from PIL import ImageChops

    # what is empty takes no part in smoothing
    weight = _sums_of_nine(drawn.astype(np.float32))
    smooth = _sums_of_nine(np.where(drawn, light, 0.0).astype(np.float32))
    factor = np.where(weight > 0.0, 255.0 * smooth / np.maximum(weight, 1.0), 255.0).astype(np.uint8)
    rows, columns = picture.shape[:2]
    fine = Pillow.fromarray(factor).resize((columns, rows), Pillow.Resampling.BILINEAR)
    # opacity stays
    factors = Pillow.merge("CMYK", (fine, fine, fine, Pillow.new("L", fine.size, 255)))
    colors = Pillow.frombuffer("CMYK", fine.size, picture.tobytes(), "raw", "CMYK", 0, 1)
    return np.asarray(ImageChops.multiply(colors, factors))


def _sums_of_nine(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Each pixel and its neighbours; those beyond the rim are as on it."""
    wide = np.pad(values, 1, mode="edge")
    rows = wide[:-2] + wide[1:-1] + wide[2:]
    return np.asarray(rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:])
