"""The range of colours of a field, and the round numbers beside its bar."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..output.frame import FieldSpec
from .coloring import Colors, Scale, magnitude
from .timeline import Frames

# A peak that lasts less than this share of the frames and rises above this multiple of the rest is a
# transient: it takes the last colour, and the bar says how far it goes.
_LASTING = 0.9
_SPIKE = 1.5
_POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def make_scale(
    spec: FieldSpec,
    values: Frames,
    limits: tuple[float, float] | None = None,
    colormap: str | None = None,
) -> Scale:
    """Find the range of a field over the whole run; vectors are shown by their length.

    Zero is always in it. A field of both signs gets a diverging map centred on zero.

    Args:
        spec: The field.
        values: Of every frame.
        limits: Values of the first and the last colour, in place of those found.
        colormap: Matplotlib name, in place of the usual map.
    """
    lows, highs = _extremes(values)
    least, largest = float(lows.min(initial=0.0)), float(highs.max(initial=0.0))
    lower, upper = _lasting(-lows), _lasting(highs)
    signed = lower > 0.0 < upper
    if signed:
        lower = upper = max(lower, upper)
    if lower == upper == 0.0:
        upper = 1.0
    usual = "RdBu_r" if signed else "viridis" if upper else "viridis_r"
    first, last = (-lower, upper) if limits is None else limits
    unit = "" if spec.unit == "1" else f" [{pretty(spec.unit)}]"
    return Scale(
        label=spec.long_name + unit,
        lower=first + 0.0,
        upper=last,
        least=least,
        largest=largest,
        table=_colors(colormap or usual),
    )


def _colors(colormap: str) -> Colors:
    """The map of a Matplotlib name, shape (256, 3): those who draw need not load Matplotlib for it."""
    from matplotlib import colormaps

    return (colormaps[colormap](np.arange(256))[:, :3] * 255).round().astype(np.uint8)


def _extremes(values: Frames) -> tuple[FloatArray, FloatArray]:
    """Least and largest finite value of each frame that has one; shape (frames,) each."""
    lows, highs = [], []
    for frame in range(len(values)):
        shown = magnitude(values[frame])
        finite = shown[np.isfinite(shown)]
        if len(finite):
            lows.append(finite.min())
            highs.append(finite.max())
    return np.array(lows), np.array(highs)


def _lasting(peaks: FloatArray) -> float:
    """The largest of the peaks of all frames, unless it is a transient; zero without any above zero."""
    highest = float(peaks.max(initial=0.0))
    ordinary = float(np.quantile(peaks, _LASTING)) if len(peaks) else 0.0
    return highest if highest <= _SPIKE * ordinary or ordinary <= 0.0 else ordinary


def ticks(scale: Scale, most: int = 6) -> list[float]:
    """Round values within a scale, at most ``most`` and at least two."""
    span = scale.upper - scale.lower
    power = 10.0 ** np.floor(np.log10(span / most))
    step = next(power * s for s in (1.0, 2.0, 2.5, 5.0, 10.0, 20.0) if int(span / (power * s) + 1e-9) < most)
    first, last = np.ceil(scale.lower / step - 1e-9), np.floor(scale.upper / step + 1e-9)
    return [float(k * step) + 0.0 for k in np.arange(first, last + 1)]


def written(values: Sequence[float], power: int) -> list[str]:
    """Ticks as they are written, in units of a power of ten, all with the same number of decimals."""
    shown = [value / 10.0**power for value in values]
    step = shown[1] - shown[0]
    decimals = next(d for d in range(12) if abs(round(step, d) - step) < 1e-6 * step)
    return [f"{value:.{decimals}f}" for value in shown]


def exponent(scale: Scale) -> int:
    """Power of ten, a multiple of three, that ticks are written in; 0 where they are short without."""
    size = max(abs(scale.lower), abs(scale.upper))
    if 0.1 <= size < 1e5:
        return 0
    return int(np.floor(np.log10(size) / 3.0)) * 3


def pretty(unit: str) -> str:
    """A unit as it is set: ``J/m²`` for ``J/m^2``, ``N·m`` for ``N m``."""
    return re.sub(r"\^(-?\d+)", lambda power: power[1].translate(_POWERS), unit.replace(" ", "·"))


def power_of_ten(power: int) -> str:
    """``10⁻³`` for -3."""
    return "10" + str(power).translate(_POWERS)
