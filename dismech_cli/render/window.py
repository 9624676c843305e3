"""A window of VTK that nobody sees, and what is read from it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from .settings import Rgb

# Drawing at twice the size and averaging smooths edges with four samples for each pixel; in software
# rendering this takes half the time of VTK's own SSAA and FXAA passes, and of its multisampling.
OVERSAMPLING = 2
_COARSE = 16  # pixels of the window for one of the look at what is empty


class Window:
    """Colours, opacities and depths of a scene.

    Attributes:
        plotter: The stage.
    """

    def __init__(self, size: tuple[int, int], paper: Rgb, oversampling: int = OVERSAMPLING) -> None:
        """Open it.

        Args:
            size: Width and height of the pictures [pixel].
            paper: Colour of the background.
            oversampling: Pixels of the window for one of a picture, along each side.
        """
        import pyvista as pv
        from vtkmodules.vtkCommonCore import vtkFloatArray, vtkUnsignedCharArray

        self._width, self._height = (oversampling * n for n in size)
        self._oversampling = oversampling
        self._paper = np.array(paper, dtype=np.uint8)
        plotter: Any = pv.Plotter(off_screen=True, window_size=[self._width, self._height], lighting="none")
        self.plotter: Any = plotter
        window: Any = self.plotter.render_window
        window.SetMultiSamples(0)
        window.SetAlphaBitPlanes(1)
        self.plotter.set_background([channel / 255 for channel in paper])
        self.plotter.renderer.SetBackgroundAlpha(0.0)
        # At most one thing is translucent: passes that sort several would take longer than the picture.
        self.plotter.renderer.SetUseOIT(False)
        self._colors, self._depths = vtkUnsignedCharArray(), vtkFloatArray()

    def aim(
        self,
        basis: FloatArray,
        center: FloatArray,
        half_height: float,
        distance: float,
        reach: float,
        angle: float = 0.0,
    ) -> None:
        """Place the camera.

        Args:
            basis: Rows right, up, towards the viewer; shape (3, 3).
            center: Middle of the picture.
            half_height: Half the height of the picture.
            distance: From the eye to the middle.
            reach: What is drawn lies nearer than this to the plane through the middle.
            angle: Height of the field of view [rad]; 0 is a parallel projection.
        """
        camera = self.plotter.camera
        camera.focal_point = tuple(center)
        camera.position = tuple(center + distance * basis[2])
        camera.up = tuple(basis[1])
        camera.parallel_projection = angle == 0.0
        if angle:
            camera.view_angle = float(np.degrees(angle))
        else:
            camera.parallel_scale = half_height
        camera.clipping_range = (max(distance - reach, 1e-3 * distance), distance + reach)

    def shoot(self) -> tuple[NDArray[np.uint8], tuple[slice, slice]]:
        """Draw.

        Returns:
            Colours and opacity of a part of the picture, shape (rows, columns, 4), and where it is: the
            rest is empty. Colours are those on the paper, wherever it shows through.
        """
        from PIL import Image

        window = self.plotter.render_window
        window.Render()
        window.GetRGBACharPixelData(0, 0, self._width - 1, self._height - 1, 1, self._colors, 0)
        # rows come from the foot of the picture
        whole = _numbers(self._colors).reshape(self._height, self._width, 4)
        rows, columns = (self._filled(whole, axis) for axis in (0, 1))
        part = np.ascontiguousarray(whole[rows, columns])
        # as CMYK, Pillow averages four channels without a thought for what they mean
        small = Image.frombuffer("CMYK", (part.shape[1], part.shape[0]), part.tobytes(), "raw", "CMYK", 0, 1)
        if self._oversampling > 1:
            small = small.reduce(self._oversampling)
        height, k = self._height // self._oversampling, self._oversampling
        place = slice(height - rows.stop // k, height - rows.start // k)
        return np.asarray(small)[::-1], (place, slice(columns.start // k, columns.stop // k))

    def _filled(self, whole: NDArray[np.uint8], axis: int) -> slice:
        """Rows or columns that are not empty, in whole pixels of the picture."""
        # what is drawn is wider than the pixels that are passed over
        filled = np.flatnonzero(whole[::2, ::2, 3].any(axis=1 - axis))
        if not len(filled):
            return slice(0, _COARSE)
        low, high = 2 * int(filled[0]) - 2, 2 * int(filled[-1]) + 3
        last = whole.shape[axis]
        return slice(max(low, 0) // _COARSE * _COARSE, min(-(-high // _COARSE) * _COARSE, last))

    def depths(self, where: tuple[slice, slice], stride: int) -> FloatArray:
        """Distances from the plane of the eye in a part of the picture, infinite where nothing is drawn.

        Args:
            where: As :meth:`shoot` returns it.
            stride: Pixels of the picture for one of the result, along each side.
        """
        window, camera = self.plotter.render_window, self.plotter.camera
        k = self._oversampling
        top, foot = (self._height - k * row for row in (where[0].start, where[0].stop))
        left, right = k * where[1].start, k * where[1].stop
        window.GetZbufferData(left, foot, right - 1, top - 1, self._depths)
        z = _numbers(self._depths).reshape(top - foot, right - left)[::-1][:: k * stride, :: k * stride]
        near, far = camera.clipping_range
        deep = near + z * (far - near)
        if not camera.parallel_projection:
            deep = near * far / (far - z * (far - near))
        return np.where(z < 1.0, deep, np.inf)

    def close(self) -> None:
        """Let go of the graphics library."""
        self.plotter.close()


def _numbers(array: Any) -> Any:
    """An array of VTK as one of NumPy."""
    from vtkmodules.util import numpy_support

    module: Any = numpy_support
    return module.vtk_to_numpy(array)
