"""Pictures without OpenGL: the same parts as shaded triangles, painted from back to front."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arrays import FloatArray
from .coloring import INK, PAPER, Colors, paled
from .contact_marks import contact_marks
from .figures import empty_figure
from .ground import grid_lines
from .job import Stage
from .joint_marks import joint_marks
from .obstacle_parts import obstacle_parts
from .parts import Part, make_bodies, make_parts
from .settings import Image, Settings
from .timeline import Shot

_SIDES, _ROUND = 12, 32  # of a rod, of an obstacle
_LIGHT = np.array([-0.45, 0.60, 0.66])  # towards the light; right, up, towards the viewer
_DPI = 100.0

Triangles = tuple[FloatArray, FloatArray, FloatArray]
"""Corners in the picture [m] (F, 3, 2), depths towards the viewer [m] (F,), colours in 0..1 (F, 3)."""


def draw(stage: Stage) -> Iterator[Image]:
    """Yield one picture per shot; see :class:`.job.Renderer`."""
    settings, least = stage.settings, stage.framing.least_radius(stage.settings.size)
    marks: list[Part] = [*joint_marks(stage.run, settings, least, _SIDES)]
    marks += contact_marks(stage.run, settings, stage.framing.half_height, _SIDES)
    marks += obstacle_parts(settings.obstacles, stage.framing, _ROUND)
    parts = [*make_parts(stage.run, least, _SIDES), *marks]
    bodies = make_bodies(stage.run, least, _SIDES) if stage.ghosts else []
    for number, shot in enumerate(stage.shots):
        shown = [_seen(stage, part, shot, number, stage.painter.colors(part, shot)) for part in parts]
        for ghost in (ghost for ghost in stage.ghosts if ghost.t < shot.t):
            for part in bodies:
                corners, depths, lit = _seen(stage, part, ghost, number, stage.painter.colors(part, ghost))
                shown.append((corners, depths, paled(lit * 255, settings.background) / 255))
        lines = np.empty((0, 2, 3))
        if settings.ground != "none":
            lines = stage.framing.seen(grid_lines(stage.framing), number)
        trails = stage.framing.seen(stage.trails(shot), number)
        yield _paint(shown, lines, trails, settings, stage.framing.half_height)


def _seen(stage: Stage, part: Part, shot: Shot, number: int, colors: Colors) -> Triangles:
    """The triangles of a part that face the viewer, lit."""
    vertices, normals = part.place(shot.t, shot.between(stage.run.positions))
    corners = stage.framing.seen(vertices, number)[part.faces]
    sides = corners[:, 1:, :2] - corners[:, :1, :2]
    # a part that a failed run left is not finite, and not greater than anything
    facing = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0] > 0.0
    faces, corners = part.faces[facing], corners[facing]
    base = colors[faces].mean(axis=1) / 255
    toward = normals[faces].mean(axis=1) @ stage.framing.basis.T
    return corners[..., :2], corners[..., 2].mean(axis=1), _shade(toward, base)


def _shade(normals: FloatArray, colors: FloatArray) -> FloatArray:
    """Lambert shading with a highlight; ``normals`` face the viewer."""
    light = _LIGHT / np.linalg.norm(_LIGHT)
    halfway = light + np.array([0.0, 0.0, 1.0])
    halfway /= np.linalg.norm(halfway)
    diffuse = np.clip(normals @ light, 0.0, 1.0)[:, None]
    highlight = np.clip(normals @ halfway, 0.0, 1.0)[:, None] ** 28
    return np.asarray(np.clip(colors * (0.42 + 0.66 * diffuse) + 0.18 * highlight, 0.0, 1.0))


def _paint(
    shown: list[Triangles], lines: FloatArray, trails: FloatArray, settings: Settings, half_height: float
) -> Image:
    width, height = settings.size
    clear = settings.background == "transparent"
    paper, ink = (tuple(c / 255 for c in table[settings.background]) for table in (PAPER, INK))
    facecolor: Any = (*paper, 0.0 if clear else 1.0)
    figure = empty_figure(width / _DPI, height / _DPI, dpi=_DPI, facecolor=facecolor)
    canvas: Any = figure.canvas
    from matplotlib.collections import LineCollection, PolyCollection

    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    half_width = half_height * width / height
    axes.set(xlim=(-half_width, half_width), ylim=(-half_height, half_height))
    axes.set_axis_off()
    axes.add_collection(LineCollection(list(lines[:, :, :2]), colors=[(*ink, 0.2)], linewidths=0.6))
    corners = np.concatenate([part[0] for part in shown])
    order = np.argsort(np.concatenate([part[1] for part in shown]), kind="stable")
    colors = np.concatenate([part[2] for part in shown])[order]
    # Edges of the same colour hide the hairlines between neighbouring triangles.
    axes.add_collection(
        PolyCollection(list(corners[order]), facecolors=colors, edgecolors=colors, linewidths=0.5)
    )
    axes.add_collection(LineCollection(list(trails[:, :, :2]), colors=[ink], linewidths=height / 360))
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, : 4 if clear else 3].copy()
