"""Lines that nodes leave behind."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from .settings import Rgb
from .window import OVERSAMPLING

WIDTH = 1 / 360  # of the height of the picture


class Trails:
    """One line for each node, on the stage of VTK."""

    def __init__(self, height: int, color: Rgb, origin: FloatArray, plotter: Any) -> None:
        """Draw nothing yet.

        Args:
            height: Of the picture [pixel].
            color: Of the lines.
            origin: What positions on the stage are relative to [m].
            plotter: The stage.
        """
        import pyvista as pv

        self._origin = origin
        self._lines: Any = pv.PolyData(np.zeros((2, 3), dtype=np.float32), lines=[2, 0, 1])
        width = max(2.0, OVERSAMPLING * height * WIDTH)
        plotter.add_mesh(self._lines, color=[c / 255 for c in color], line_width=width, lighting=False)

    def draw(self, paths: FloatArray) -> None:
        """Show the paths [m], shape (K, points, 3)."""
        import pyvista as pv

        points = (paths - self._origin).reshape(-1, 3).astype(np.float32)
        self._lines.copy_from(pv.PolyData(points, lines=_lines(*paths.shape[:2])))


def _lines(count: int, length: int) -> IntArray:
    """Lines as VTK lists them: the number of points, then the points."""
    numbers = np.arange(count * length).reshape(count, length)
    return np.column_stack((np.full(count, length), numbers)).reshape(-1)
