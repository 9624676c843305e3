"""Several pictures as one figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .settings import Image

_ACROSS = 3


def side_by_side(pictures: Sequence[Image]) -> Image:
    """Pictures of one size in rows of at most three; what is left over in the last row is as their corner."""
    across = min(_ACROSS, len(pictures))
    across = 2 if len(pictures) == 4 else across
    down = -(-len(pictures) // across)
    height, width, channels = pictures[0].shape
    figure = np.empty((down * height, across * width, channels), dtype=np.uint8)
    figure[:] = pictures[0][0, -1]
    for number, picture in enumerate(pictures):
        row, column = divmod(number, across)
        figure[row * height : (row + 1) * height, column * width : (column + 1) * width] = picture
    return figure
