"""Arrows for the forces of contact, from the nodes that they act on."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..output.read import Run
from .settings import Rgb, Settings
from .timeline import Frames, shot_at

FORCE = "contact_force"

_COLOR: Rgb = (196, 52, 44)
# Length of the longest over half of the height of the picture; in units of the length of each: the place
# where its head starts, and the radii of the shaft and of the head.
_LONGEST, _NECK, _SHAFT, _HEAD = 0.3, 0.68, 0.035, 0.1
# What is shorter than this share of the longest is not drawn.
_SHORTEST = 0.02


@frozen(kw_only=True)
class Arrows:
    """Arrows along vectors at nodes, as long as these are large; implements :class:`.parts.Part`.

    Attributes:
        nodes: Where they start, shape (K,).
        times: Of the frames [s], shape (F,).
        vectors: Of all nodes in each frame.
        scale: Length of a vector of 1 [m].
        longest: Length of the longest [m].
        shape: Vertices of an arrow along z of length 1, shape (P, 3).
        normals: Its normals, shape (P, 3).
        faces: See :class:`.parts.Part`.
        source: See there.
        body: See there.
    """

    nodes: IntArray
    times: FloatArray
    vectors: Frames
    scale: float
    longest: float
    shape: FloatArray
    normals: FloatArray
    faces: IntArray
    source: IntArray
    body: IntArray
    color: ClassVar[Rgb] = _COLOR
    meshed: ClassVar[bool] = False

    def place(self, t: float, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Vertices [m] and outward unit normals, shape (K P, 3) each."""
        vectors = self.scale * shot_at(self.times, t).between(self.vectors)[self.nodes]
        length = np.linalg.norm(vectors, axis=1)
        length[length < _SHORTEST * self.longest] = 0.0
        turns = _turns(vectors)
        at = positions[self.nodes][:, None] + length[:, None, None] * (self.shape @ turns)
        return at.reshape(-1, 3), np.reshape(self.normals @ turns, (-1, 3))


def contact_marks(run: Run, settings: Settings, half_height: float, sides: int) -> list[Arrows]:
    """The arrows of a run, if they are to be shown and anything touches in it.

    Args:
        run: The run.
        settings: What the pictures show.
        half_height: Half of the height of the picture [m].
        sides: Of an arrow.

    Raises:
        OutputError: The run does not have the forces.
    """
    if not settings.contacts:
        return []
    vectors = run.field(FORCE)
    largest = np.zeros(len(run.topology.rest_positions))
    for frame in range(len(run)):
        np.maximum(largest, np.nan_to_num(np.linalg.norm(vectors[frame], axis=1)), out=largest)
    nodes = np.flatnonzero(largest)
    if not len(nodes):
        return []
    shape, normals, faces = _arrow(sides)
    shift = np.arange(len(nodes))[:, None, None] * len(shape)
    source = np.repeat(nodes, len(shape))
    arrows = Arrows(
        nodes=nodes,
        times=run.t,
        vectors=vectors,
        scale=_LONGEST * half_height / float(largest.max()),
        longest=_LONGEST * half_height,
        shape=shape,
        normals=normals,
        faces=(faces + shift).reshape(-1, 3),
        source=source,
        body=np.zeros(len(source), dtype=np.int64),
    )
    return [arrows]


def _arrow(sides: int) -> tuple[FloatArray, FloatArray, IntArray]:
    """Vertices, normals and triangles of an arrow along z: bottom, shaft, rim of the head, head."""
    steep = float(np.hypot(_HEAD, 1.0 - _NECK))
    # two rings each, with the height and the radius of either, and a normal along z and outwards
    rings = (
        ((0.0, 0.0), (0.0, _SHAFT), (-1.0, 0.0)),
        ((0.0, _SHAFT), (_NECK, _SHAFT), (0.0, 1.0)),
        ((_NECK, _SHAFT), (_NECK, _HEAD), (-1.0, 0.0)),
        ((_NECK, _HEAD), (1.0, 0.0), (_HEAD / steep, (1.0 - _NECK) / steep)),
    )
    angle = 2.0 * np.pi * np.arange(sides) / sides
    around = np.stack((np.cos(angle), np.sin(angle), np.zeros(sides)), axis=1)
    upwards = np.array([0.0, 0.0, 1.0])
    vertices, normals, faces = [], [], []
    here, following = np.arange(sides), np.roll(np.arange(sides), -1)
    for number, (low, high, (along, out)) in enumerate(rings):
        for height, radius in (low, high):
            vertices.append(radius * around + height * upwards)
            normals.append(out * around + along * upwards)
        a, b = 2 * number * sides, (2 * number + 1) * sides
        faces.append(np.stack((a + here, a + following, b + following), axis=1))
        faces.append(np.stack((a + here, b + following, b + here), axis=1))
    return np.concatenate(vertices), np.concatenate(normals), np.concatenate(faces)


def _turns(vectors: FloatArray) -> FloatArray:
    """Rotations that take z to the direction of each vector, as rows, shape (K, 3, 3)."""
    z = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), np.finfo(float).tiny)
    z = np.where((z * z).sum(axis=1, keepdims=True) > 0.5, z, [0.0, 0.0, 1.0])
    # the axis that is least along it
    other = np.eye(3)[np.abs(z).argmin(axis=1)]
    x = np.cross(other, z)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack((x, np.cross(z, x), z), axis=1)
