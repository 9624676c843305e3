"""Pictures by VTK, off-screen: rods as tubes of their true radius, shells as thin solids."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .actors import PartActor
from .coloring import INK, PAPER, paled
from .contact_marks import contact_marks
from .floor import Floor
from .ground import grid_lines
from .job import Stage
from .joint_marks import joint_marks
from .obstacle_parts import obstacle_parts
from .occlusion import darken, openness
from .parts import Part, make_bodies, make_parts
from .polydata import lines, make_lines
from .settings import Image, Settings
from .shading import add_lights, fade
from .timeline import Shot
from .trails import Trails
from .window import Window

_SIDES, _ROUND = 24, 48  # of a rod, of an obstacle
_EDGE_ON = 0.05  # a floor seen from its side is a line
_FAINT = 0.2  # share of the ink in a line of the grid
_STRIDE = 2  # pixels of the picture for one of the grid of occlusion
_BALL = 0.035  # of the height of the picture: radius of the ball that is looked at in corners


def draw(stage: Stage) -> Iterator[Image]:
    """Yield one picture per shot; see :class:`.job.Renderer`."""
    scene = Scene(stage)
    try:
        for number, shot in enumerate(stage.shots):
            scene.set(shot)
            yield scene.shoot(number)
    finally:
        scene.close()


class Scene:
    """All that stands on the stage."""

    def __init__(self, stage: Stage) -> None:
        settings, framing = stage.settings, stage.framing
        self._stage = stage
        self._origin = framing.centers[0]
        self._paper = np.array(PAPER[settings.background], dtype=np.uint8)
        self._blank = _blank(settings)
        self._window = Window(settings.size, PAPER[settings.background])
        renderer = self._window.renderer
        add_lights(renderer)
        least = framing.least_radius(settings.size)
        if settings.ground == "grid" or (settings.ground == "floor" and abs(framing.basis[2, 2]) < _EDGE_ON):
            self._add_grid()
        marks: list[Part] = [*joint_marks(stage.run, settings, least, _SIDES)]
        marks += contact_marks(stage.run, settings, stage.framing.half_height, _SIDES)
        marks += obstacle_parts(settings.obstacles, stage.framing, _ROUND)
        self._actors = [self._actor(part) for part in (*make_parts(stage.run, least, _SIDES), *marks)]
        self._ghosts = [self._ghost(shot, make_bodies(stage.run, least, _SIDES)) for shot in stage.ghosts]
        self._trails = None
        if settings.trails:
            ink = INK[settings.background]
            self._trails = Trails(settings.size[1], ink, self._origin, renderer)
        self._floor = Floor(framing, self._origin, renderer) if settings.ground == "floor" else None

    def set(self, shot: Shot) -> None:
        """Move everything."""
        positions = shot.between(self._stage.run.positions)
        for actor in self._actors:
            actor.move(shot.t, positions)
            actor.paint(self._stage.painter.colors(actor.part, shot))
        for ghost, t in zip(self._ghosts, self._stage.settings.ghosts, strict=True):
            for one in ghost:
                one.SetVisibility(t < shot.t)
        if self._trails is not None:
            self._trails.draw(self._stage.trails(shot))
        if self._floor is not None:
            self._floor.cast(self._actors)

    def shoot(self, number: int) -> Image:
        """The picture of a shot, by its number."""
        framing = self._stage.framing
        reach = 8.0 * (framing.depth + framing.half_height)
        center = framing.centers[number] - self._origin
        self._window.aim(framing.basis, center, framing.half_height, framing.distance, reach, framing.angle)
        part, where = self._window.shoot()
        if self._floor is not None:
            part = self._shade(part, where)
        picture = self._blank.copy()
        shown = _without_paper(part, self._paper) if self._blank.shape[2] == 4 else part
        # rows of bytes go faster than three bytes at a time
        for channel in range(picture.shape[2]):
            picture[where][..., channel] = shown[..., channel]
        return picture

    def close(self) -> None:
        """Let go of the graphics library."""
        if self._floor is not None:
            self._floor.close()
        self._window.close()

    def _actor(self, part: Part, *, mesh: bool = True) -> PartActor:
        settings, parallel = self._stage.settings, not self._stage.framing.angle
        shown = mesh and settings.mesh
        actor = PartActor(part, self._origin, smooth=settings.smooth, mesh=shown, parallel=parallel)
        self._window.renderer.AddActor(actor.actor)
        return actor

    def _ghost(self, shot: Shot, parts: list[Part]) -> list[Any]:
        """An earlier shape, nearly in the colour of the background; it moves no more."""
        stage, shown = self._stage, []
        for part in parts:
            actor = self._actor(part, mesh=False)
            shown.append(actor.actor)
            fade(actor.actor)
            # where the shape of now is at the same place, it is seen
            mapper = actor.actor.GetMapper()
            mapper.SetResolveCoincidentTopologyToPolygonOffset()
            mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(4.0, 4.0)
            actor.move(shot.t, shot.between(stage.run.positions))
            actor.paint(paled(stage.painter.colors(part, shot), stage.settings.background))
        return shown

    def _add_grid(self) -> None:
        background = self._stage.settings.background
        ink, paper = np.array(INK[background]), np.array(PAPER[background])
        points = (grid_lines(self._stage.framing) - self._origin).reshape(-1, 3).astype(np.float32)
        red, green, blue = (_FAINT * ink + (1.0 - _FAINT) * paper).tolist()
        ends = np.arange(len(points)).reshape(-1, 2)
        self._window.renderer.AddActor(make_lines(lines(points, ends), (red, green, blue), 2.0))

    def _shade(self, part: Image, where: tuple[slice, slice]) -> Image:
        """Less light in corners."""
        size, framing = self._stage.settings.size, self._stage.framing
        depths = self._window.depths(where, _STRIDE)
        radius, pixel = max(2, round(_BALL * size[1] / _STRIDE)), _STRIDE * framing.pixel(size)
        light = openness(depths, radius, pixel)
        return darken(part, light, np.isfinite(depths))


def _blank(settings: Settings) -> Image:
    """A picture of nothing."""
    width, height = settings.size
    if settings.background == "transparent":
        return np.zeros((height, width, 4), dtype=np.uint8)
    return np.tile(np.array(PAPER[settings.background], dtype=np.uint8), (height, width, 1))


def _without_paper(part: Image, paper: Image) -> Image:
    """Colours of what covers the paper, without what shows through."""
    opacity = part[..., 3:].astype(np.float64) / 255
    colors = (part[..., :3] - (1.0 - opacity) * paper) / np.maximum(opacity, 1 / 255)
    return np.concatenate((np.clip(colors, 0, 255).round().astype(np.uint8), part[..., 3:]), axis=2)
