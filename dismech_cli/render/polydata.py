"""Surfaces and lines of VTK over arrays of NumPy, which are not copied."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import IntArray
from .settings import Rgb


def as_vtk(array: Any) -> Any:
    """A contiguous array of NumPy as one of VTK."""
    from vtkmodules.util import numpy_support

    module: Any = numpy_support
    return module.numpy_to_vtk(np.ascontiguousarray(array))


def as_numpy(array: Any) -> Any:
    """An array of VTK as one of NumPy."""
    from vtkmodules.util import numpy_support

    module: Any = numpy_support
    return module.vtk_to_numpy(array)


def surface(points: Any, faces: IntArray) -> Any:
    """Triangles.

    Args:
        points: Single precision, shape (P, 3).
        faces: Shape (F, 3).
    """
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    data = vtkPolyData()
    set_points(data, points)
    set_faces(data, faces)
    return data


def lines(points: Any, chains: IntArray) -> Any:
    """Open lines.

    Args:
        points: Single precision, shape (P, 3).
        chains: Points of each line, shape (lines, length).
    """
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    data = vtkPolyData()
    set_points(data, points)
    set_lines(data, chains)
    return data


def set_points(data: Any, points: Any) -> None:
    """Give surfaces or lines other points, shape (P, 3)."""
    from vtkmodules.vtkCommonCore import vtkPoints

    held = vtkPoints()
    held.SetData(as_vtk(points))
    data.SetPoints(held)


def set_faces(data: Any, faces: IntArray) -> None:
    """Give a surface other triangles, shape (F, 3)."""
    data.SetPolys(_cells(faces))


def set_lines(data: Any, chains: IntArray) -> None:
    """Give other lines, shape (lines, length)."""
    data.SetLines(_cells(chains))


def _cells(points: IntArray) -> Any:
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    module: Any = numpy_support
    numbers = np.ascontiguousarray(points, dtype=np.int64).reshape(-1)
    cells: Any = vtkCellArray()
    cells.SetData(points.shape[1], module.numpy_to_vtkIdTypeArray(numbers, deep=True))
    return cells


def make_actor(data: Any) -> Any:
    """What stands on the stage for surfaces or lines."""
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    return actor


def make_lines(data: Any, color: Rgb, width: float) -> Any:
    """What stands on the stage for lines of one colour that no light changes; the width in pixels."""
    actor = make_actor(data)
    actor.GetProperty().SetColor(*(channel / 255 for channel in color))
    actor.GetProperty().SetLineWidth(width)
    actor.GetProperty().LightingOff()
    return actor
