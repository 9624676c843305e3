"""A stage of VTK that nobody sees, and what is read from it."""

from __future__ import annotations

import itertools
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from .settings import Image, Rgb

# Drawing at twice the size and averaging smooths edges with four samples for each pixel; in software
# rendering this takes half the time of VTK's own SSAA and FXAA passes, and of its multisampling.
OVERSAMPLING = 2
_COARSE = 16  # pixels of the window for one of the look at what is empty, and more than half a line


class Window:
    """Colours, opacities and depths of a scene.

    Attributes:
        renderer: The stage.
    """

    def __init__(self, size: tuple[int, int], paper: Rgb, oversampling: int = OVERSAMPLING) -> None:
        """Open it.

        Args:
            size: Width and height of the pictures [pixel].
            paper: Colour of the background.
            oversampling: Pixels of the window for one of a picture, along each side.
        """
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  what draws
        from vtkmodules.vtkCommonCore import vtkFloatArray, vtkUnsignedCharArray
        from vtkmodules.vtkRenderingCore import vtkCamera, vtkRenderer, vtkRenderWindow

        self._width, self._height = (oversampling * n for n in size)
        self._oversampling = oversampling
        self.renderer: Any = vtkRenderer()
        self.renderer.AutomaticLightCreationOff()
        self._camera: Any = vtkCamera()
        self.renderer.SetActiveCamera(self._camera)
        self.renderer.SetBackground(*(channel / 255 for channel in paper))
        self.renderer.SetBackgroundAlpha(0.0)
        # At most one thing is translucent: passes that sort several would take longer than the picture.
        self.renderer.SetUseOIT(False)
        self._window: Any = vtkRenderWindow()
        self._window.SetOffScreenRendering(True)
        if sys.platform == "darwin":
            self._window.SetConnectContextToNSView(False)  # else off-screen windows open all the same
        self._window.SetSize(self._width, self._height)
        self._window.AddRenderer(self.renderer)
        self._window.SetMultiSamples(0)
        self._window.SetAlphaBitPlanes(1)
        # Nobody looks at the window: pictures are read where they are drawn.
        self._window.SwapBuffersOff()
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
        camera = self._camera
        camera.SetFocalPoint(*center)
        camera.SetPosition(*(center + distance * basis[2]))
        camera.SetViewUp(*basis[1])
        camera.SetParallelProjection(angle == 0.0)
        if angle:
            camera.SetViewAngle(float(np.degrees(angle)))
        else:
            camera.SetParallelScale(half_height)
        camera.SetClippingRange(max(distance - reach, 1e-3 * distance), distance + reach)

    def shoot(self) -> tuple[Image, tuple[slice, slice]]:
        """Draw.

        Returns:
            Colours and opacity of a part of the picture, shape (rows, columns, 4), and where it is: the
            rest is empty. Colours are those on the paper, wherever it shows through.
        """
        from PIL import Image as Pillow

        self._window.Render()
        up, across = self._reach()
        back = 0
        self._window.GetRGBACharPixelData(
            across.start, up.start, across.stop - 1, up.stop - 1, back, self._colors, 0
        )
        # rows come from the foot of the picture
        width = across.stop - across.start
        read = _values(self._colors).reshape(up.stop - up.start, width, 4)
        rows, columns = _filled(read)
        count = rows.stop - rows.start
        # as CMYK, Pillow averages four channels without a thought for what they mean
        strip = Pillow.frombuffer("CMYK", (width, count), read[rows].reshape(-1), "raw", "CMYK", 0, -1)
        k = self._oversampling
        part = strip.reduce(k, (columns.start, 0, columns.stop, count))
        left, foot = across.start + columns.start, self._height - up.start - rows.start
        place = slice((foot - count) // k, foot // k)
        return np.asarray(part), (place, slice(left // k, left // k + part.width))

    def _reach(self) -> tuple[slice, slice]:
        """Rows from the foot of the window and columns that hold all that stands on the stage."""
        bounds = np.reshape(self.renderer.ComputeVisiblePropBounds(), (3, 2))
        corners = np.array([*itertools.product(*bounds, (1.0,))])
        matrix = self._camera.GetCompositeProjectionTransformMatrix(self._width / self._height, -1.0, 1.0)
        seen = corners @ [[matrix.GetElement(row, column) for row in range(4)] for column in range(4)]
        if (seen[:, 3] <= 0.0).any():
            # something is behind the eye
            return slice(0, self._height), slice(0, self._width)
        across, up = 0.5 + 0.5 * seen[:, :2].T / seen[:, 3]
        return _around(up * self._height, self._height), _around(across * self._width, self._width)

    def depths(self, where: tuple[slice, slice], stride: int) -> FloatArray:
        """Distances from the plane of the eye in a part of the picture, infinite where nothing is drawn.

        Args:
            where: As :meth:`shoot` returns it.
            stride: Pixels of the picture for one of the result, along each side.
        """
        k = self._oversampling
        top, foot = (self._height - k * row for row in (where[0].start, where[0].stop))
        left, right = k * where[1].start, k * where[1].stop
        self._window.GetZbufferData(left, foot, right - 1, top - 1, self._depths)
        z = _values(self._depths).reshape(top - foot, right - left)[::-1][:: k * stride, :: k * stride]
        near, far = self._camera.GetClippingRange()
        deep = near + z * (far - near)
        if not self._camera.GetParallelProjection():
            deep = near * far / (far - z * (far - near))
        return np.where(z < 1.0, deep, np.inf)

    def close(self) -> None:
        """Let go of the graphics library."""
        self._window.Finalize()


def _values(array: Any) -> NDArray[Any]:
    """The numbers of an array of VTK, where they are, shape (tuples, components)."""
    from vtkmodules.util import numpy_support

    see: Any = numpy_support.vtk_to_numpy
    return np.asarray(see(array))


def _around(places: FloatArray, last: int) -> slice:
    """From the first to the last of these, of ``last``, and a little more for the width of lines."""
    low, high = places.min() // _COARSE - 1, places.max() // _COARSE + 2
    start = int(np.clip(low * _COARSE, 0, last - _COARSE))
    return slice(start, int(np.clip(high * _COARSE, start + _COARSE, last)))


def _filled(whole: Image) -> tuple[slice, slice]:
    """Rows and columns that are not empty, in whole pixels of the picture."""
    # Four channels as one number; what is drawn is wider than the rows that are passed over.
    opaque = np.array([0, 0, 0, 255], dtype=np.uint8).view(np.uint32)
    pixels = whole.view(np.uint32)[..., 0]
    rows = _between(np.bitwise_or.reduce(pixels[::2], axis=1) & opaque, 2, whole.shape[0])
    return rows, _between(np.bitwise_or.reduce(pixels[rows], axis=0) & opaque, 1, whole.shape[1])


def _between(opacity: NDArray[np.uint32], stride: int, last: int) -> slice:
    """From the first to the last that is opaque, of every ``stride``-th of ``last``, and a little more."""
    filled = np.flatnonzero(opacity)
    if not len(filled):
        return slice(0, _COARSE)
    low, high = stride * int(filled[0]) - 2, stride * int(filled[-1]) + 3
    return slice(max(low, 0) // _COARSE * _COARSE, min(-(-high // _COARSE) * _COARSE, last))
