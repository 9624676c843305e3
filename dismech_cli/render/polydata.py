"""Surfaces and lines of pyvista, and what stands on the stage for them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import IntArray
from .settings import Rgb


def surface(points: Any, faces: Any) -> Any:
    """Triangles.

    Args:
        points: Single precision, shape (P, 3).
        faces: Whole numbers, shape (F, 3).
    """
    import pyvista as pv

    return pv.PolyData.from_regular_faces(points, faces)


def lines(points: Any, chains: IntArray) -> Any:
    """Open lines.

    Args:
        points: Single precision, shape (P, 3).
        chains: Points of each line, shape (lines, length).
    """
    import pyvista as pv

    return pv.PolyData(points, lines=chain_cells(chains))


def chain_cells(chains: IntArray) -> IntArray:
    """Lines as VTK writes them: how many points, then which; chains of shape (lines, length)."""
    return np.insert(chains, 0, chains.shape[1], axis=1).reshape(-1)


def make_actor(data: Any) -> Any:
    """What stands on the stage for surfaces or lines."""
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor: Any = vtkActor()
    actor.SetMapper(mapper)
    return actor


def make_lines(data: Any, color: Rgb, width: float) -> Any:
    """What stands on the stage for lines of one colour that no light changes; the width in pixels."""
    actor = make_actor(data)
    look = actor.GetProperty()
    look.SetColor(*(channel / 255 for channel in color))
    look.SetLineWidth(width)
    look.LightingOff()
    return actor
