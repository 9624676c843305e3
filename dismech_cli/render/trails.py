"""Lines that nodes leave behind."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray
from .polydata import chain_cells, lines, make_lines
from .settings import Rgb
from .window import OVERSAMPLING

WIDTH = 1 / 360  # of the height of the picture


class Trails:
    """One line for each node, on the stage."""

    def __init__(self, height: int, color: Rgb, origin: FloatArray, renderer: Any) -> None:
        """Draw nothing yet.

        Args:
            height: Of the picture [pixel].
            color: Of the lines.
            origin: What positions on the stage are relative to [m].
            renderer: The stage.
        """
        self._origin = origin
        self._lines: Any = lines(np.zeros((2, 3), dtype=np.float32), np.array([[0, 1]]))
        width = max(2.0, OVERSAMPLING * height * WIDTH)
        renderer.AddActor(make_lines(self._lines, color, width))

    def draw(self, paths: FloatArray) -> None:
        """Show the paths [m], shape (K, points, 3)."""
        self._lines.points = (paths - self._origin).reshape(-1, 3).astype(np.float32)
        count, length = paths.shape[:2]
        self._lines.lines = chain_cells(np.arange(count * length).reshape(count, length))
