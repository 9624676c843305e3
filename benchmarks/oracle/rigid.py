"""Obstacles of a run, as whoever looks at its frames sees them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from dismech_cli import Report
from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.contact.contact import Contact
from dismech_cli.contact.obstacles.obstacle import HalfSpace, Obstacle, Rounded
from dismech_cli.contact.obstacles.pose import Pose
from dismech_cli.contact.obstacles.rigid_surface import RigidSurface
from dismech_cli.contact.pieces.cores import BoxCore, LineCore, PointCore, SegmentCore

from .distances import between_segments, to_segment

# A cylinder is so long [m], and lines are looked at in so many places where no formula is at hand.
_ENDLESS: Final = 1e3
_PLACES: Final = np.linspace(0.0, 1.0, 33)[:, None]


@dataclass(frozen=True, slots=True)
class Rigid:
    """The obstacles of a run; those of triangles are as bodies that never bend.

    Attributes:
        solid: Those that have an inside, with the bodies that may touch them.
        surfaces: Where those of triangles are, their shape, and the same.
        triangles: Corners of all of these, shape (T, 3).
    """

    solid: tuple[tuple[Obstacle, frozenset[int]], ...]
    surfaces: tuple[tuple[Pose, RigidSurface, frozenset[int]], ...]
    triangles: IntArray

    @classmethod
    def of(cls, report: Report) -> Self:
        """Those of a run."""
        solid, surfaces = [], []
        triangles, count = [np.empty((0, 3), dtype=np.int64)], 0
        for contact in report.composition.simulation.model.changing:
            assert isinstance(contact, Contact)
            for wall in contact.walls:
                touching = frozenset(wall.lines.bodies.tolist())
                shape = wall.obstacle.shape
                if not isinstance(shape, RigidSurface):
                    solid.append((wall.obstacle, touching))
                    continue
                surfaces.append((wall.obstacle.pose, shape, touching))
                triangles.append(count + shape.triangles)
                count += len(shape.vertices)
        return cls(tuple(solid), tuple(surfaces), np.concatenate(triangles))

    def vertices(self, t: float) -> FloatArray:
        """Of those of triangles at time ``t`` [s], in space [m], shape (V, 3)."""
        places = [np.empty((0, 3))]
        for pose, shape, _ in self.surfaces:
            places.append(pose.at(t).outward(shape.vertices.T).T)
        return np.concatenate(places)

    def gaps(self, t: float, ends: FloatArray, body: IntArray) -> FloatArray:
        """Least distance of lines with ends (2, 3, E) [m] from solids, below zero inside, shape (E,)."""
        out = np.full(len(body), np.inf)
        for one, bodies in self.solid:
            may = np.flatnonzero(np.isin(body, list(bodies)))
            frame = one.pose.at(t)
            own = np.stack([frame.inward(end) for end in ends[:, :, may]])
            out[may] = np.minimum(out[may], _gaps(one, own))
        return out


def _gaps(one: Obstacle, ends: FloatArray) -> FloatArray:
    """Of lines with ends (2, 3, E) in the frame of an obstacle."""
    first, last = ends
    match one.shape:
        case HalfSpace(point=point, normal=n):
            return np.asarray(np.minimum(n @ first, n @ last) - n @ point)
        case Rounded(core=PointCore(centre=c), radius=r):
            return to_segment(np.broadcast_to(c[:, None], first.shape), first, last) - r
        case Rounded(core=LineCore(point=p, axis=axis), radius=r):
            return _from_axis(ends, p - _ENDLESS * axis, p + _ENDLESS * axis) - r
        case Rounded(core=SegmentCore(first=a, second=b), radius=r):
            return _from_axis(ends, a, b) - r
        case Rounded(core=BoxCore(half=half), radius=r):
            x = first[:, None] + _PLACES * (last - first)[:, None]
            over = np.abs(x) - half[:, None, None]
            outside = np.linalg.norm(np.maximum(over, 0.0), axis=0)
            return np.asarray((outside + np.minimum(over.max(axis=0), 0.0)).min(axis=0) - r)
        case other:
            raise NotImplementedError(f"no distance from {type(other).__name__}")


def _from_axis(ends: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    axis = np.broadcast_to(np.stack((a, b))[:, :, None], ends.shape)
    return between_segments(np.concatenate((ends, axis)))
