"""Labels on a picture: the time, a length scale and a colour bar; the same for every renderer."""

from __future__ import annotations

import functools
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from .coloring import INK, Scale
from .scales import exponent, power_of_ten, ticks, written
from .settings import Image, Settings
from .timeline import Shot

if TYPE_CHECKING:
    from PIL import Image as Pillow
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont

Box: TypeAlias = tuple[int, int, int, int]
"""Left, top, right and bottom [pixel]."""

_PREFIXES = ((1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))
_SMALLEST_TEXT = 10  # pixel, below which nobody can read it
_TEXT = 1 / 30  # of the height of the picture


class Labels:
    """What is written on the pictures of a run: all but the time is drawn once."""

    def __init__(self, settings: Settings, pixel: float | None, scale: Scale | None) -> None:
        """Draw it.

        Args:
            settings: What the pictures show.
            pixel: Width of a pixel [m], or None where it is not the same everywhere.
            scale: The colours of a field, or None.
        """
        self._ink = INK[settings.background]
        self._height = max(settings.size[1] * _TEXT * settings.text, _SMALLEST_TEXT)
        self._none = settings.text == 0.0
        self._margin = 0.9 * self._height
        self._pieces: list[tuple[Box, Pillow.Image]] = []
        if not self._none and pixel is not None:
            self._keep(settings, lambda pen: self._length_scale(pen, settings, pixel))
        if not self._none and scale is not None:
            self._keep(settings, lambda pen: self._color_bar(pen, scale, settings.size[1]))

    def _keep(self, settings: Settings, drawn: Callable[[ImageDraw], None]) -> None:
        """Keep the part of an empty picture that something was drawn on."""
        from PIL import Image as Pillow
        from PIL import ImageDraw

        canvas = Pillow.new("RGBA", settings.size, (*self._ink, 0))
        drawn(ImageDraw.Draw(canvas))
        box = canvas.getchannel("A").getbbox()
        if box is not None:
            self._pieces.append((box, canvas.crop(box)))

    def write(self, image: Image, shot: Shot, decimals: int) -> None:
        """Write them on a picture.

        Args:
            image: RGB or RGBA, shape (height, width, channels); changed.
            shot: What is shown.
            decimals: Digits of the time after the point, the same in all frames of a film.
        """
        from PIL import Image as Pillow
        from PIL import ImageDraw

        if self._none:
            return
        for box, piece in self._pieces:
            place = _place(box)
            below = Pillow.fromarray(image[place])
            if below.mode == "RGBA":
                below = Pillow.alpha_composite(below, piece)
            else:
                below.paste(piece, mask=piece.getchannel("A"))
            image[place] = np.asarray(below)
        foot = image.shape[0] - self._margin
        speed = "" if shot.speed == 1.0 else f"   (speed {shot.speed:.4g})"
        text = f"t = {shot.t:.{decimals}f} s{speed}"
        # only the strip of the text is taken out of the picture
        top = max(int(foot - 2.0 * self._height), 0)
        strip = Pillow.fromarray(image[top:])
        at = (self._margin, foot - top)
        ImageDraw.Draw(strip).text(at, text, self._ink, font(self._height), anchor="ls")
        image[top:] = np.asarray(strip)

    def _length_scale(self, pen: ImageDraw, settings: Settings, pixel: float) -> None:
        height, foot = self._height, settings.size[1] - self._margin
        length = round_length(8.0 * height * pixel)
        factor, symbol = next((entry for entry in _PREFIXES if length >= entry[0]), _PREFIXES[-1])
        right = settings.size[0] - self._margin
        left = right - length / pixel
        width, tick = max(1, round(height / 11)), height / 4
        pen.line([(left, foot), (right, foot)], self._ink, width)
        for end in (left, right):
            pen.line([(end, foot - tick), (end, foot)], self._ink, width)
        text = f"{length / factor:g} {symbol}"
        middle = ((left + right) / 2, foot - 0.35 * height)
        pen.text(middle, text, self._ink, font(0.85 * height), anchor="ms")

    def _color_bar(self, pen: ImageDraw, scale: Scale, rows: int) -> None:
        height, left, top = self._height, self._margin, 3.1 * self._height
        width = max(4, round(0.62 * height))
        long = min(round(10.5 * height), round(0.6 * rows))
        strip = scale.colors(np.linspace(scale.upper, scale.lower, long))
        for row, color in enumerate(strip.tolist()):
            pen.line([(left, top + row), (left + width, top + row)], tuple(color), 1)
        power = exponent(scale)
        unit = 10.0**power
        label = scale.label if not power else _with_power(scale.label, power)
        small = font(0.85 * height)
        pen.text((left, top - 0.85 * height), label, self._ink, font(0.92 * height), anchor="ls")
        values = ticks(scale)
        for value, shown in zip(values, written(values, power), strict=True):
            y = top + (scale.upper - value) / (scale.upper - scale.lower) * (long - 1)
            mark = [(left + width, y), (left + width + height / 4, y)]
            pen.line(mark, self._ink, max(1, round(height / 20)))
            pen.text((left + width + 0.45 * height, y), shown, self._ink, small, anchor="lm")
        beyond = [
            f"{word} {value / unit:.3g}"
            for word, value, out in (
                ("max", scale.largest, scale.largest > scale.upper),
                ("min", scale.least, scale.least < scale.lower),
            )
            if out
        ]
        if beyond:
            below = (left, top + long + 1.0 * height)
            pen.text(below, ", ".join(beyond), self._ink, small, anchor="ls")


def _place(box: Box) -> tuple[slice, slice]:
    """Rows and columns of left, top, right and bottom."""
    left, top, right, bottom = box
    return slice(top, bottom), slice(left, right)


def _with_power(label: str, power: int) -> str:
    """The power of ten before the unit, if there is one."""
    name, bracket, unit = label.partition(" [")
    return f"{name} [{power_of_ten(power)} {unit}" if bracket else f"{name} [{power_of_ten(power)}]"


def round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``length``."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(step for step in (1, 2, 5) if step * power <= length * (1 + 1e-9)))


def font(height: float) -> FreeTypeFont:
    """The font in a height [pixel]."""
    return _font(max(_SMALLEST_TEXT, round(height)))


@functools.cache
def _font(size: int) -> FreeTypeFont:
    # Matplotlib ships this font, so that pictures look the same on every machine; importing it takes longer
    # than ten pictures.
    from PIL import ImageFont

    library = find_spec("matplotlib")
    assert library is not None
    assert library.origin is not None
    fonts = Path(library.origin).parent / "mpl-data" / "fonts" / "ttf"
    return ImageFont.truetype(fonts / "DejaVuSans.ttf", size)
