"""Pictures by VTK, off-screen: rods as tubes of their true radius, shells as thin solids."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..output.frame import Topology
from ..output.read import Run
from .chains import find_chains, find_junctions
from .coloring import Colors, Scale, body_colors, field_colors
from .framing import Framing
from .ground import grid_lines
from .job import Image as Picture
from .settings import Settings
from .shell_solid import ShellSolid, make_shells

_BACKGROUND = ("#e3e9ef", "#fcfdfe")  # bottom, top
_GRID_COLOR = "#cbd4dc"
_MESH_COLOR = "#101820"
_SIDES = 24
# Drawing at twice the size and averaging smooths edges with four samples for each pixel; in software
# rendering this takes half the time of VTK's own SSAA and FXAA passes.
_OVERSAMPLING = 2
_MATERIAL = {
    "ambient": 0.34,
    "diffuse": 0.74,
    "specular": 0.26,
    "specular_power": 30.0,
    "interpolation": "Phong",
}


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
    rods = _Rods(run.topology, least)
    shells = [_Shell(solid, least) for solid in make_shells(run.topology)]
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


def _finish(actor: Any) -> None:
    for name, value in _MATERIAL.items():
        setattr(actor.prop, name, value)


class _Rods:
    """One surface for all rods: a tube along every chain, a ball at every junction."""

    def __init__(self, topology: Topology, least: float) -> None:
        import pyvista as pv

        chains = find_chains(topology.edges, topology.edge_radius, topology.edge_body)
        self._lengths = [len(chain.nodes) for chain in chains]
        self._nodes = np.concatenate([chain.nodes for chain in chains]) if chains else _no_nodes()
        self._radius = np.maximum(np.concatenate([[], *(chain.radius for chain in chains)]), least)
        bodies = np.repeat(np.array([chain.body for chain in chains], dtype=np.int64), self._lengths)
        self._own_colors = body_colors(bodies)
        self._junctions, radius, junction_bodies = find_junctions(chains)
        self._ball_radius = np.maximum(radius, least)
        self._ball_colors = body_colors(junction_bodies)
        self._ball: Any = pv.Sphere(radius=1.0, theta_resolution=_SIDES, phi_resolution=_SIDES)
        self._surface: Any = pv.PolyData()

    def add_to(self, plotter: Any) -> None:
        if not len(self._nodes):
            return
        actor = plotter.add_mesh(self._placeholder(), scalars="rgb", rgb=True)
        _finish(actor)

    def _placeholder(self) -> Any:
        import pyvista as pv

        self._surface = pv.PolyData(np.zeros((3, 3)), faces=[3, 0, 1, 2])
        self._surface["rgb"] = np.zeros((3, 3), dtype=np.uint8)
        return self._surface

    def move(self, positions: FloatArray, colors: Colors | None) -> None:
        import pyvista as pv

        if not len(self._nodes):
            return
        starts = np.cumsum([0, *self._lengths[:-1]])
        lines = np.concatenate(
            [
                np.concatenate([[length], start + np.arange(length)])
                for start, length in zip(starts, self._lengths, strict=True)
            ]
        )
        path: Any = pv.PolyData(positions[self._nodes], lines=lines)
        path["rgb"] = self._own_colors if colors is None else colors[self._nodes]
        path["radius"] = self._radius
        surface = path.tube(scalars="radius", absolute=True, n_sides=_SIDES, capping=True)
        balls = self._balls(positions, colors)
        self._surface.copy_from(surface if balls is None else surface.append_polydata(balls))

    def _balls(self, positions: FloatArray, colors: Colors | None) -> Any:
        import pyvista as pv

        count = len(self._junctions)
        if not count:
            return None
        points = np.asarray(self._ball.points, dtype=np.float64)
        faces = self._ball.regular_faces
        shift = np.arange(count)[:, None, None] * len(points)
        placed = positions[self._junctions][:, None] + self._ball_radius[:, None, None] * points
        balls: Any = pv.PolyData.from_regular_faces(placed.reshape(-1, 3), (faces + shift).reshape(-1, 3))
        own = self._ball_colors if colors is None else colors[self._junctions]
        balls["rgb"] = np.repeat(own, len(points), axis=0)
        balls["radius"] = np.repeat(self._ball_radius, len(points))
        balls.point_data.active_normals = np.tile(points, (count, 1))
        return balls


class _Shell:
    """The closed surface of one shell body."""

    def __init__(self, solid: ShellSolid, least: float) -> None:
        self._solid = solid
        self._least = least / 2
        self._own_colors = body_colors(np.full(len(solid.source), solid.body, dtype=np.int64))
        self._surface: Any = None

    def add_to(self, plotter: Any) -> None:
        import pyvista as pv

        points = np.zeros((len(self._solid.source), 3))
        faces: Any = self._solid.faces
        self._surface = pv.PolyData.from_regular_faces(points, faces)
        self._surface["rgb"] = self._own_colors
        self._surface.point_data.active_normals = points + np.array([0.0, 0.0, 1.0])
        # Each face of the thin solid has a twin behind it: hiding those turned away avoids flicker.
        actor = plotter.add_mesh(
            self._surface,
            scalars="rgb",
            rgb=True,
            culling="back",
            show_edges=True,
            edge_color=_MESH_COLOR,
            edge_opacity=0.25,
        )
        _finish(actor)

    def move(self, positions: FloatArray, colors: Colors | None) -> None:
        vertices, normals = self._solid.vertices(positions, self._least)
        self._surface.points = vertices
        self._surface.point_data.active_normals = normals
        self._surface["rgb"] = self._own_colors if colors is None else colors[self._solid.source]


def _no_nodes() -> IntArray:
    return np.empty(0, dtype=np.int64)
