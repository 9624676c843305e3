"""Obstacles: boxes with rounded edges, which are balls where they have no sides and capsules with one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .framing import Framing
from .settings import Rgb, Solid
from .timeline import shot_at
from .tubes import unit

_COLOR: Rgb = (206, 210, 216)
# Of half of the height of the picture: half of an unbounded side, and the thickness of a plane.
_UNBOUNDED, _SHEET = 2.0, 0.04


@frozen(kw_only=True)
class RigidPart:
    """A rigid surface; implements :class:`.parts.Part`.

    Attributes:
        solid: Where it is.
        vertices: In its own frame [m], shape (V, 3).
        normals: Shape (V, 3).
        faces: See :class:`.parts.Part`.
        source: See there.
        body: See there.
    """

    solid: Solid
    vertices: FloatArray
    normals: FloatArray
    faces: IntArray
    source: IntArray
    body: IntArray
    color: ClassVar[Rgb] = _COLOR
    meshed: ClassVar[bool] = False

    def place(self, t: float, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Vertices [m] and outward unit normals, shape (V, 3) each."""
        shot = shot_at(self.solid.times, t)
        turn = shot.between(self.solid.turns)
        return shot.between(self.solid.origins) + self.vertices @ turn.T, self.normals @ turn.T


def obstacle_parts(solids: Sequence[Solid], framing: Framing, sides: int) -> list[RigidPart]:
    """The obstacles of a scene, those without bounds as far as the first picture reaches.

    Args:
        solids: Obstacles.
        framing: The camera.
        sides: Of a round one; a multiple of 4.
    """
    return [_sheet(one) if len(one.triangles) else _box(one, framing, sides) for one in solids]


def _box(solid: Solid, framing: Framing, sides: int) -> RigidPart:
    half = np.array(solid.half)
    unbounded = np.isinf(half)
    middle = np.where(unbounded, solid.turns[0].T @ (framing.centers[0] - solid.origins[0]), 0.0)
    half[unbounded] = _UNBOUNDED * framing.half_height
    if solid.plane:
        half[2] = 0.5 * _SHEET * framing.half_height
        middle[2] = -half[2]
    normals, corner, faces = _BLOCK if solid.plane else _rounded(sides)
    nothing = np.zeros(len(normals), dtype=np.int64)
    return RigidPart(
        solid=solid,
        vertices=middle + corner * half + solid.radius * normals,
        normals=normals,
        faces=faces,
        source=nothing,
        body=nothing,
    )


def _sheet(solid: Solid) -> RigidPart:
    """Both sides of triangles, each flat and in the middle of the thickness, so that none gape."""
    corners = solid.triangles
    normal = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    vertices = np.concatenate((corners, corners[:, ::-1])).reshape(-1, 3)
    nothing = np.zeros(len(vertices), dtype=np.int64)
    return RigidPart(
        solid=solid,
        vertices=vertices,
        normals=np.repeat(np.concatenate((normal, -normal)), 3, axis=0),
        faces=np.arange(len(vertices)).reshape(-1, 3),
        source=nothing,
        body=nothing,
    )


def _rounded(sides: int) -> tuple[FloatArray, FloatArray, IntArray]:
    """Normals of a box with rounded edges, the corner (of signs) that each is at, and triangles.

    A ball of meridians and parallels, cut in eight along the planes between its axes.
    """
    quarter = np.linspace(0.0, 0.5 * np.pi, sides // 4 + 1)
    around = np.concatenate([quarter + 0.5 * np.pi * k for k in range(4)])
    east = np.repeat([[1, 1], [-1, 1], [-1, -1], [1, -1]], len(quarter), axis=0)
    down = np.concatenate((quarter, quarter + 0.5 * np.pi))
    up = np.repeat([1, -1], len(quarter))
    columns, rows = len(around), len(down)
    x, y = np.sin(down)[:, None] * np.cos(around), np.sin(down)[:, None] * np.sin(around)
    normals = np.stack((x, y, np.broadcast_to(np.cos(down)[:, None], x.shape)), axis=-1).reshape(-1, 3)
    corner = np.concatenate((np.tile(east, (rows, 1)), np.repeat(up, columns)[:, None]), axis=1)
    grid = np.arange(rows * columns).reshape(rows, columns)
    a, b = grid[:-1], np.roll(grid, -1, axis=1)[:-1]
    c, d = grid[1:], np.roll(grid, -1, axis=1)[1:]
    faces = [np.stack((a, c, d), axis=-1), np.stack((a, d, b), axis=-1)]
    first, last = grid[0, :: len(quarter)], grid[-1, :: len(quarter)]
    quads = np.array([[0, 1, 2], [0, 2, 3]])
    faces += [first[quads], last[quads[:, ::-1]]]
    joined = np.concatenate([part.reshape(-1, 3) for part in faces])
    return normals, corner.astype(np.float64), joined


def _block() -> tuple[FloatArray, FloatArray, IntArray]:
    """The same of a box with sharp edges."""
    axes = np.concatenate((np.eye(3), -np.eye(3)))
    across = np.roll(axes, 1, axis=1)
    ring = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corner = np.stack([axes + s * across + w * np.cross(axes, across) for s, w in ring], axis=1)
    faces = 4 * np.arange(6)[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])
    return np.repeat(axes, 4, axis=0), corner.reshape(-1, 3), faces.reshape(-1, 3)


_BLOCK = _block()
