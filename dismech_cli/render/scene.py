"""Pictures by VTK, off-screen: rods as tubes of their true radius, shells as thin solids."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..output.read import Run
from .actors import RodActor, ShellActor
from .coloring import Scale, field_colors
from .framing import Framing
from .ground import grid_lines
from .job import Image as Picture
from .settings import Settings
from .shell_solid import make_shells

_BACKGROUND = ("#e3e9ef", "#fcfdfe")  # bottom, top
_GRID_COLOR = "#cbd4dc"
# Drawing at twice the size and averaging smooths edges with four samples for each pixel; in software
# rendering this takes half the time of VTK's own SSAA and FXAA passes.
_OVERSAMPLING = 2


def draw(
    run: Run, frames: Sequence[int], settings: Settings, framing: Framing, scale: Scale | None
) -> Iterator[Picture]:
    """Yield one picture per frame.

    Args:
        run: The open run.
        frames: Frame numbers.
        settings: What the pictures show.
        framing: The camera, fitted to the run.
        scale: Colours of the field, or None for one colour per body.
    """
    import pyvista as pv
    from PIL import Image

    plotter: Any = pv.Plotter(
        off_screen=True, window_size=[_OVERSAMPLING * n for n in settings.size], lighting="none"
    )
    plotter.render_window.SetMultiSamples(0)
    plotter.set_background(_BACKGROUND[0], top=_BACKGROUND[1])
    _add_lights(plotter)
    if settings.ground == "grid":
        grid: Any = pv.line_segments_from_points(grid_lines(framing).reshape(-1, 3))
        plotter.add_mesh(grid, color=_GRID_COLOR, line_width=2.0, lighting=False)
    least = framing.least_radius(settings.size)
    rods = RodActor(run.topology, least)
    shells = [ShellActor(solid, least) for solid in make_shells(run.topology)]
    rods.add_to(plotter)
    for shell in shells:
        shell.add_to(plotter)
    try:
        for frame in frames:
            positions = run.positions[frame]
            on_rods, on_shells = (None, None) if scale is None else field_colors(run, scale, frame)
            rods.move(positions, on_rods)
            for shell in shells:
                shell.move(positions, on_shells)
            _aim(plotter, framing, frame)
            # Without this, a screenshot shows the first frame again.
            plotter.render()
            drawn = Image.fromarray(np.asarray(plotter.screenshot(None, return_img=True))[:, :, :3])
            yield np.asarray(drawn.reduce(_OVERSAMPLING))
    finally:
        plotter.close()


def _add_lights(plotter: Any) -> None:
    """Key, fill and back light that turn with the camera, so that every view is lit alike."""
    import pyvista as pv

    for position, intensity, color in (
        ((-0.7, 1.1, 1.3), 0.90, "#fffaf2"),
        ((1.2, 0.1, 0.9), 0.34, "#dfeaff"),
        ((0.0, -1.0, 0.6), 0.12, "#ffffff"),
    ):
        plotter.add_light(
            pv.Light(position=position, intensity=intensity, color=color, light_type="camera light")
        )


def _aim(plotter: Any, framing: Framing, frame: int) -> None:
    center = framing.centers[frame]
    distance = 4.0 * (framing.depth + framing.half_height)
    camera = plotter.camera
    camera.focal_point = tuple(center)
    camera.position = tuple(center + distance * framing.basis[2])
    camera.up = tuple(framing.basis[1])
    camera.parallel_projection = True
    camera.parallel_scale = framing.half_height
    plotter.renderer.reset_camera_clipping_range()
