"""Pictures without OpenGL: the same scene as shaded polygons, painted from back to front."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..output.read import Run
from .chains import Chain, find_chains, find_junctions
from .coloring import Colors, Scale, body_colors, field_colors
from .framing import Framing
from .ground import grid_lines
from .job import Image
from .settings import Settings
from .shell_solid import ShellSolid, make_shells

_STRIPS = 7  # lengthwise strips that shade a tube
_BACKGROUND = np.array([[252, 253, 254], [227, 233, 239]], dtype=np.float64)  # top, bottom
_LIGHT = np.array([-0.45, 0.60, 0.66])  # towards the light; right, up, towards the viewer
_CIRCLE = np.exp(2j * np.pi * np.arange(20) / 20)

Polygons = tuple[list[FloatArray], FloatArray, FloatArray]
"""Corners in the picture [m], depths towards the viewer [m], colours in 0..1."""


def draw(
    run: Run, frames: Sequence[int], settings: Settings, framing: Framing, scale: Scale | None
) -> Iterator[Image]:
    """Yield one picture per frame; see :func:`dismech_cli.render.scene.draw`."""
    topology = run.topology
    chains = find_chains(topology.edges, topology.edge_radius, topology.edge_body)
    shells = make_shells(topology)
    least = framing.least_radius(settings.size)
    for frame in frames:
        seen = (run.positions[frame] - framing.centers[frame]) @ framing.basis.T
        rods, sheets = (None, None) if scale is None else field_colors(run, scale, frame)
        parts = [_tube(chain, seen, rods, least) for chain in chains]
        parts += [_ball(*ball, seen, rods, least) for ball in zip(*find_junctions(chains), strict=True)]
        parts += [_sheet(shell, seen, sheets) for shell in shells]
        lines = np.empty((0, 2, 3))
        if settings.ground == "grid":
            lines = (grid_lines(framing) - framing.centers[frame]) @ framing.basis.T
        yield _paint(parts, lines, settings, framing)


def _shade(normals: FloatArray, colors: FloatArray) -> FloatArray:
    """Lambert shading with a highlight; ``normals`` face the viewer."""
    light = _LIGHT / np.linalg.norm(_LIGHT)
    halfway = light + np.array([0.0, 0.0, 1.0])
    halfway /= np.linalg.norm(halfway)
    diffuse = np.clip(normals @ light, 0.0, 1.0)[:, None]
    highlight = np.clip(normals @ halfway, 0.0, 1.0)[:, None] ** 28
    return np.asarray(np.clip(colors * (0.42 + 0.66 * diffuse) + 0.18 * highlight, 0.0, 1.0))


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300))


def _tube(chain: Chain, seen: FloatArray, colors: Colors | None, least: float) -> Polygons:
    points = seen[chain.nodes]
    steps = _unit(np.diff(points, axis=0))
    first = steps[-1:] + steps[:1] if chain.closed else steps[:1]
    last = first if chain.closed else steps[-1:]
    tangent = _unit(np.concatenate([first, steps[:-1] + steps[1:], last]))
    # Across the tube in the picture; where the tube points at the viewer any direction will do.
    across = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(length > 1e-9, across / np.maximum(length, 1e-300), [1.0, 0.0])
    side = np.column_stack([across, np.zeros(len(across))])
    facing = _unit(np.cross(side, tangent))
    facing *= np.where(facing[:, 2:] < 0, -1.0, 1.0)
    radius = np.maximum(chain.radius, least)[:, None]
    base = (body_colors(np.full(len(points), chain.body)) if colors is None else colors[chain.nodes]) / 255
    base = (base[:-1] + base[1:]) / 2
    corners: list[FloatArray] = []
    depths, shades = [], []
    edges = np.sin(np.linspace(-np.pi / 2, np.pi / 2, _STRIPS + 1))
    for low, high in itertools.pairwise(edges.tolist()):
        a, b = points[:, :2] + radius * low * across, points[:, :2] + radius * high * across
        corners += list(np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=1))
        middle = (low + high) / 2
        normal = _unit((middle * side + np.sqrt(1 - middle**2) * facing)[:-1])
        depths.append((points[:-1, 2] + points[1:, 2]) / 2)
        shades.append(_shade(normal, base))
    return corners, np.concatenate(depths), np.concatenate(shades)


def _ball(
    node: int, radius: float, body: int, seen: FloatArray, colors: Colors | None, least: float
) -> Polygons:
    """Three discs that look like a lit ball."""
    base = (body_colors(np.array([body])) if colors is None else colors[[node]]) / 255
    size = max(radius, least)
    corners, depths, shades = [], [], []
    for share, shift in ((1.0, 0.0), (0.75, 0.12), (0.45, 0.25)):
        offset = size * (share * _CIRCLE + shift * (_LIGHT[0] + 1j * _LIGHT[1]))
        corners.append(seen[node, :2] + np.column_stack([offset.real, offset.imag]))
        depths.append(seen[node, 2] + size * (1 - share))
        tilt = np.array([[shift * _LIGHT[0] * 2, shift * _LIGHT[1] * 2, 1.0]])
        shades.append(_shade(_unit(tilt), base * (0.75 + 0.25 * (1 - share))))
    return corners, np.array(depths), np.concatenate(shades)


def _sheet(shell: ShellSolid, seen: FloatArray, colors: Colors | None) -> Polygons:
    points = seen[shell.nodes]
    triangles = points[shell.triangles]
    normals = _unit(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    normals = normals * np.where(normals[:, 2:] < 0, -1.0, 1.0)
    nodal = body_colors(np.full(len(points), shell.body)) if colors is None else colors[shell.nodes]
    base = nodal[shell.triangles].mean(axis=1) / 255
    return list(triangles[:, :, :2]), triangles[:, :, 2].mean(axis=1), _shade(normals, base)


def _paint(parts: list[Polygons], lines: FloatArray, settings: Settings, framing: Framing) -> Image:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.figure import Figure

    width, height = settings.size
    dpi = 100.0
    figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi)
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    half_width = framing.half_height * width / height
    axes.set(xlim=(-half_width, half_width), ylim=(-framing.half_height, framing.half_height))
    axes.set_axis_off()
    gradient = np.linspace(_BACKGROUND[0], _BACKGROUND[1], 256)[:, None] / 255
    axes.imshow(
        gradient,
        extent=(-half_width, half_width, -framing.half_height, framing.half_height),
        aspect="auto",
        interpolation="bilinear",
    )
    axes.add_collection(LineCollection(list(lines[:, :, :2]), colors="#d3dbe2", linewidths=0.6))
    corners = [polygon for part in parts for polygon in part[0]]
    if corners:
        order = np.argsort(np.concatenate([part[1] for part in parts]), kind="stable")
        colors = np.concatenate([part[2] for part in parts])[order]
        # Edges of the same colour hide the hairlines between neighbouring polygons.
        axes.add_collection(
            PolyCollection(
                [corners[index] for index in order], facecolors=colors, edgecolors=colors, linewidths=0.5
            )
        )
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
