"""Balls where rods meet or end: they close the gaps between the tubes, and round their ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .chains import Chain, find_chain_ends
from .settings import Rgb


@frozen(kw_only=True)
class Balls:
    """Equal balls but for their radius.

    Attributes:
        nodes: In their middles, shape (K,).
        radius: Shape (K,) [m].
        normals: Of one ball, shape (P, 3).
        faces: See :class:`.parts.Part`.
        source: See there.
        body: See there.
        color: See there.
    """

    nodes: IntArray
    radius: FloatArray
    normals: FloatArray
    faces: IntArray
    source: IntArray
    body: IntArray
    color: Rgb | None = None
    meshed: ClassVar[bool] = False

    def place(self, t: float, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Vertices [m] and outward unit normals, shape (K P, 3) each."""
        vertices = positions[self.nodes][:, None] + self.radius[:, None, None] * self.normals
        return vertices.reshape(-1, 3), np.tile(self.normals, (len(self.nodes), 1))


def make_balls(chains: Sequence[Chain], least: float, sides: int, fewest: int) -> list[Balls]:
    """The balls at nodes with so many ends of chains; none without such a node.

    Args:
        chains: Of all rods.
        least: Least radius that is drawn [m].
        sides: Meridians.
        fewest: Ends at a node that has a ball: 2 for junctions alone, 1 where ends of rods are round.
    """
    nodes, radius, body = find_chain_ends(list(chains), fewest)
    return [balls_at(nodes, np.maximum(radius, least), body, sides)] if len(nodes) else []


def balls_at(
    nodes: IntArray, radius: FloatArray, body: IntArray, sides: int, color: Rgb | None = None
) -> Balls:
    """Balls around nodes; arguments as the attributes of :class:`Balls`, and the number of meridians."""
    normals, faces = _sphere(sides)
    shift = np.arange(len(nodes))[:, None, None] * len(normals)
    return Balls(
        nodes=nodes,
        radius=radius,
        normals=normals,
        faces=(faces + shift).reshape(-1, 3),
        source=np.repeat(nodes, len(normals)),
        body=np.repeat(body, len(normals)),
        color=color,
    )


def _sphere(sides: int) -> tuple[FloatArray, IntArray]:
    """A unit sphere of meridians and parallels, whose poles are rings of no size."""
    parallels = sides // 2 + 1
    height = np.linspace(0.0, np.pi, parallels)[:, None]
    around = 2.0 * np.pi * np.arange(sides) / sides
    x, y = np.sin(height) * np.cos(around), np.sin(height) * np.sin(around)
    points = np.stack((x, y, np.broadcast_to(np.cos(height), x.shape)), axis=-1).reshape(-1, 3)
    a = (np.arange(parallels - 1)[:, None] * sides + np.arange(sides)).reshape(-1)
    b = (np.arange(parallels - 1)[:, None] * sides + (np.arange(sides) + 1) % sides).reshape(-1)
    faces = np.concatenate((np.stack((a, a + sides, b + sides), 1), np.stack((a, b + sides, b), 1)))
    return points, faces
