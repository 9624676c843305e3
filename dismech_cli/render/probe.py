"""Can this machine draw? Tried in a process of its own, which may die of it."""

from __future__ import annotations

import functools
import subprocess
from importlib.util import find_spec
from typing import Any, Literal

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
    reason = _try_pyvista()
    if reason is None:
        return "pyvista"
    if find_spec("matplotlib") is not None:
        return "matplotlib"
    raise RenderError(_ADVICE.format(reason=reason))


def _try_pyvista() -> str | None:
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


def draw_ball() -> None:
    """Draw a dark ball on white, off-screen.

    Raises:
        RuntimeError: If the picture stays white.
    """
    import pyvista as pv

    plotter: Any = pv.Plotter(off_screen=True, window_size=[64, 64])
    plotter.set_background("white")
    plotter.add_mesh(pv.Sphere(), color="black")
    image = plotter.screenshot(None, return_img=True)
    if image is None or not image.min() < 128 < image.max():
        raise RuntimeError("the picture is empty")


if __name__ == "__main__":
    draw_ball()
