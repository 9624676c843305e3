"""Lines on the floor."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from .framing import Framing
from .overlay import round_length

_REACH = 24


def grid_lines(framing: Framing) -> FloatArray:
    """Lines at round distances on the lowest level of the motion, about eight across the picture.

    Returns:
        Both ends of each line [m], shape (lines, 2, 3).
    """
    spacing = round_length(framing.half_height / 4)
    middle = framing.centers.mean(axis=0)
    ticks = np.arange(-_REACH, _REACH + 1) * spacing
    x, y = (np.round(middle[axis] / spacing) * spacing + ticks for axis in (0, 1))
    lines = np.full((2, len(ticks), 2, 3), framing.floor)
    lines[0, :, :, 0], lines[0, :, :, 1] = x[:, None], y[[0, -1]]
    lines[1, :, :, 0], lines[1, :, :, 1] = x[[0, -1]], y[:, None]
    return lines.reshape(-1, 2, 3)
