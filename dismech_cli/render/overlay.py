"""Labels on a picture: the time, a length scale and a colour bar; the same for every renderer."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .coloring import Scale
from .job import Image

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont

_INK = (58, 68, 80)
_PREFIXES = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


def add_labels(image: Image, t: float, decimals: int, pixel: float, scale: Scale | None) -> Image:
    """Write the labels into a copy of ``image``.

    Args:
        image: RGB picture, shape (height, width, 3).
        t: Time of the frame [s].
        decimals: Digits of the time after the point, the same in all frames of a video.
        pixel: Width of a pixel [m].
        scale: The colours of a field, or None.
    """
    from PIL import Image as Pillow
    from PIL import ImageDraw

    picture = Pillow.fromarray(image)
    pen = ImageDraw.Draw(picture)
    unit = max(image.shape[0], 240) / 720
    margin = 26 * unit
    bottom = image.shape[0] - margin
    pen.text((margin, bottom), f"t = {t:.{decimals}f} s", _INK, _font(round(22 * unit)), anchor="ls")
    _length_scale(pen, image.shape[1] - margin, bottom, pixel, unit)
    if scale is not None:
        _color_bar(picture, pen, scale, unit)
    return np.asarray(picture)


def _length_scale(pen: ImageDraw, right: float, bottom: float, pixel: float, unit: float) -> None:
    length = round_length(180 * unit * pixel)
    factor, symbol = next((entry for entry in _PREFIXES if length >= entry[0]), _PREFIXES[-1])
    left = right - length / pixel
    width = max(1, round(2 * unit))
    tick = 5 * unit
    pen.line([(left, bottom), (right, bottom)], _INK, width)
    for end in (left, right):
        pen.line([(end, bottom - tick), (end, bottom)], _INK, width)
    text = f"{length / factor:g} {symbol}"
    pen.text(((left + right) / 2, bottom - 7 * unit), text, _INK, _font(round(17 * unit)), anchor="ms")


def round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``length``."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(step for step in (1, 2, 5) if step * power <= length * (1 + 1e-9)))


def _color_bar(picture: object, pen: ImageDraw, scale: Scale, unit: float) -> None:
    from PIL import Image as Pillow

    width, height = round(14 * unit), round(230 * unit)
    left, top = round(28 * unit), round(62 * unit)
    values = np.linspace(scale.upper, scale.lower, height)
    strip = np.repeat(scale.colors(values)[:, None], width, axis=1)
    assert isinstance(picture, Pillow.Image)
    picture.paste(Pillow.fromarray(strip), (left, top))
    font = _font(round(16 * unit))
    pen.text((left, top - 16 * unit), scale.label, _INK, _font(round(18 * unit)), anchor="ls")
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        value = scale.upper + share * (scale.lower - scale.upper)
        y = top + share * (height - 1)
        pen.line([(left + width, y), (left + width + 5 * unit, y)], _INK, max(1, round(unit)))
        shown = 0.0 if abs(value) < 1e-9 * (scale.upper - scale.lower) else value
        pen.text((left + width + 10 * unit, y), f"{shown:.3g}", _INK, font, anchor="lm")


@functools.cache
def _font(size: int) -> FreeTypeFont:
    # Matplotlib ships this font, so that pictures look the same on every machine.
    from matplotlib import get_data_path
    from PIL import ImageFont

    return ImageFont.truetype(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", size)
