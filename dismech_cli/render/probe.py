"""Can this machine draw? Tried in a process of its own, which may die of it."""

from __future__ import annotations

import functools
import subprocess
from importlib.util import find_spec
from typing import Literal

from ..errors import RenderError
from . import child

RendererName = Literal["pyvista", "matplotlib"]

_TIMEOUT = 120.0  # [s], generous: the first import of VTK from a cold disk takes long

_ADVICE = (
    "no picture can be made on this machine: {reason}. On Debian or Ubuntu install the OpenGL libraries "
    "with 'apt-get install libegl1 libgl1-mesa-dri' (or 'apt-get install libosmesa6'), "
    "or the plain renderer with 'pip install matplotlib'"
)


@functools.cache
def find_renderer() -> RendererName:
    """Choose the best renderer that works here.

    Raises:
        RenderError: If none does; the message names the packages to install.
    """
    reason = _try_vtk()
    if reason is None:
        return "pyvista"
    if find_spec("matplotlib") is not None:
        return "matplotlib"
    raise RenderError(_ADVICE.format(reason=reason))


def _try_vtk() -> str | None:
    """None if a picture came out, else what happened instead."""
    try:
        done = subprocess.run(
            child.command("probe"),
            env=child.environment(),
            capture_output=True,
            timeout=_TIMEOUT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"VTK did not draw within {_TIMEOUT:.0f} s"
    return None if done.returncode == 0 else f"VTK ended with {child.describe_exit(done.returncode)}"


def draw_triangle() -> None:
    """Draw a dark triangle on white, off-screen.

    Raises:
        RuntimeError: If the picture stays white.
    """
    import numpy as np

    from .polydata import make_actor, surface
    from .window import Window

    window = Window((64, 64), (255, 255, 255), oversampling=1)
    points = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.0, 0.5, 0.0]], dtype=np.float32)
    triangle = make_actor(surface(points, np.array([[0, 1, 2]])))
    triangle.GetProperty().SetColor(0.0, 0.0, 0.0)
    window.renderer.AddActor(triangle)
    window.aim(np.eye(3), np.zeros(3), 1.0, 4.0, 2.0)
    image, _ = window.shoot()
    window.close()
    if not image[..., :3].min() < 128 < image[..., :3].max():
        raise RuntimeError("the picture is empty")


if __name__ == "__main__":
    draw_triangle()
