"""Where the camera stands so that the motion fills the picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..output.read import Run
from .settings import Camera, Settings, Solid, View
from .timeline import Shot, shot_at

# Room around the motion, as a share of its size.
_MARGIN = 0.10
# Of the height of the picture, by the size of the labels: the line of time and length scale at its
# foot, the name of the field at its head, and the colour bar on its left.
_LINE, _BAR = 0.08, 0.2
_LEAST_RADIUS = 0.8  # pixel
_SMALLEST = 1e-12  # [m] for a robot that is one point

_OBLIQUE = np.array([0.62, -1.0, 0.55])

# Direction towards the viewer and the upward direction of each view.
_DIRECTIONS: dict[View, tuple[FloatArray, FloatArray]] = {
    "xy": (np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])),
    "xz": (np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0])),
    "yz": (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])),
    "iso": (_OBLIQUE, np.array([0.0, 0.0, 1.0])),
}


@frozen(kw_only=True)
class Framing:
    """A camera for every shot.

    Attributes:
        basis: Rows right, up, towards the viewer; shape (3, 3).
        centers: Middle of the picture in world coordinates [m], shape (shots, 3).
        half_height: Half the height of the picture at its middle [m].
        depth: Half the depth of the scene along the line of sight [m].
        floor: Lowest z of the motion [m].
        angle: Height of the field of view [rad]; 0 is a parallel projection.
    """

    basis: FloatArray
    centers: FloatArray
    half_height: float
    depth: float
    floor: float
    angle: float

    @property
    def distance(self) -> float:
        """From the eye to the middle of the picture [m]."""
        if self.angle:
            return float(self.half_height / np.tan(self.angle / 2))
        return 4.0 * (self.depth + self.half_height)

    def pixel(self, size: tuple[int, int]) -> float:
        """Width of one pixel [m] in the middle of a picture of ``size``."""
        return 2.0 * self.half_height / size[1]

    def least_radius(self, size: tuple[int, int]) -> float:
        """Radius [m] below which a rod would vanish between the pixels."""
        return _LEAST_RADIUS * self.pixel(size)

    def seen(self, points: FloatArray, shot: int) -> FloatArray:
        """Points in the picture [m]: right, up, towards the viewer from the middle; shape as ``points``."""
        seen = (points - self.centers[shot]) @ self.basis.T
        if self.angle:
            seen[..., :2] *= self.distance / np.maximum(self.distance - seen[..., 2:], 1e-9 * self.distance)
        return np.asarray(seen)


def view_basis(camera: Camera, target: FloatArray) -> FloatArray:
    """Unit vectors right, up and towards the viewer, as rows.

    Args:
        camera: Where the eye is.
        target: What it looks at [m].
    """
    towards, upward = _DIRECTIONS[camera.view]
    if camera.eye is not None:
        towards, upward = np.subtract(camera.eye, target), np.array([0.0, 0.0, 1.0])
    if camera.up is not None:
        upward = np.array(camera.up)
    towards = towards / np.linalg.norm(towards)
    right = np.cross(upward, towards)
    if np.linalg.norm(right) < 1e-9 * np.linalg.norm(upward):
        # seen along the upward direction: another one is as good
        right = np.cross(np.eye(3)[np.abs(towards).argmin()], towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])


def frame_motion(run: Run, settings: Settings, shots: Sequence[Shot]) -> Framing:
    """Fit the camera to what is seen in some shots, and place it for each.

    Positions that are not finite, as a failed run may leave, are passed over.
    """
    camera, topology = settings.camera, run.topology
    frames = _frames(run, settings, shots)
    target = _target(run, camera, frames)
    basis = view_basis(camera, target)
    extent = _with(settings.obstacles, _extent(run, basis, camera.follow, frames), basis, run.t[frames])
    middles = _middles(extent, camera.follow)
    if camera.eye is not None or camera.target is not None:
        middles = basis @ target + middles - middles[0]
    thickest = max(topology.edge_radius.max(initial=0.0), topology.triangle_thickness.max(initial=0.0) / 2)
    reach = np.maximum(extent.upper - middles, middles - extent.lower).max(axis=0) + thickest
    half_height, shift = _fit(reach, settings)
    if camera.eye is not None and camera.angle:
        half_height = float(np.linalg.norm(np.subtract(camera.eye, target)) * np.tan(camera.angle / 2))
        shift = np.zeros(3)
    centers = (middles + half_height * shift) @ basis
    return Framing(
        basis=basis,
        centers=np.array([shot.between(dict(zip(frames, centers, strict=True))) for shot in shots]),
        half_height=half_height,
        depth=float(np.linalg.norm(reach)),
        floor=extent.floor - thickest,
        angle=camera.angle,
    )


@frozen
class _Extent:
    """What a run fills, along the axes of the picture.

    Attributes:
        lower: Of each frame that is seen [m], shape (S, 3).
        upper: Shape (S, 3).
        followed: Middle of the nodes that are followed, shape (S, 3).
        floor: Lowest z in the world.
    """

    lower: FloatArray
    upper: FloatArray
    followed: FloatArray
    floor: float


def _frames(run: Run, settings: Settings, shots: Sequence[Shot]) -> list[int]:
    """Frames that something of is seen, ascending; a trail shows those before it too."""
    ghosts = [shot_at(run.t, t) for t in settings.ghosts]
    seen = {frame for shot in (*shots, *ghosts) for frame in (shot.lower, shot.upper)}
    return list(range(max(seen) + 1)) if settings.trails else sorted(seen)


def _extent(run: Run, basis: FloatArray, follow: tuple[int, ...] | None, frames: Sequence[int]) -> _Extent:
    lower, upper, followed = np.zeros((3, len(frames), 3))
    floor = np.inf
    for frame, positions in enumerate(run.positions[number] for number in frames):
        nodes = np.array(follow, dtype=np.int64) if follow else np.arange(len(positions))
        finite = np.asarray(np.isfinite(positions).all(axis=1))
        if not finite[nodes].any():
            before = max(frame - 1, 0)
            lower[frame], upper[frame], followed[frame] = lower[before], upper[before], followed[before]
            continue
        seen = positions @ basis.T
        lower[frame], upper[frame] = seen[finite].min(axis=0), seen[finite].max(axis=0)
        followed[frame] = seen[nodes[finite[nodes]]].mean(axis=0)
        floor = min(floor, float(positions[finite, 2].min()))
    return _Extent(lower, upper, followed, floor if np.isfinite(floor) else 0.0)


def _with(solids: Sequence[Solid], extent: _Extent, basis: FloatArray, times: FloatArray) -> _Extent:
    """The extent of a run and its obstacles at times of frames; of unbounded ones only across."""
    lower, upper = extent.lower, extent.upper
    for solid in solids:
        if solid.plane:
            continue
        half = np.where(np.isinf(solid.half), 0.0, solid.half)
        for frame, t in enumerate(times):
            shot = shot_at(solid.times, float(t))
            middle, turn = basis @ shot.between(solid.origins), basis @ shot.between(solid.turns)
            reach = np.abs(turn) @ half + solid.radius
            lower[frame] = np.minimum(lower[frame], middle - reach)
            upper[frame] = np.maximum(upper[frame], middle + reach)
    return _Extent(lower, upper, extent.followed, extent.floor)


def _middles(extent: _Extent, follow: tuple[int, ...] | None) -> FloatArray:
    """What the camera looks at in each frame, along the axes of the picture; shape (S, 3)."""
    if follow is None:
        middle = (extent.lower.min(axis=0) + extent.upper.max(axis=0)) / 2
        return np.tile(middle, (len(extent.lower), 1))
    return extent.followed if follow else (extent.lower + extent.upper) / 2


def _target(run: Run, camera: Camera, frames: Sequence[int]) -> FloatArray:
    """What the camera looks at unless it follows: the middle of the motion, if an eye needs one [m]."""
    if camera.target is not None:
        return np.array(camera.target)
    if camera.eye is None:
        return np.zeros(3)
    return np.asarray(_middles(_extent(run, np.eye(3), None, frames), None)[0])


def _fit(reach: FloatArray, settings: Settings) -> tuple[float, FloatArray]:
    """Half the height of the picture [m], and what its middle is off that of the motion as a share of it."""
    aspect = settings.size[0] / settings.size[1]
    foot = min(_LINE * settings.text, 0.3)
    head, bar = 0.0, 0.0
    if settings.color_by is not None:
        head, bar = foot, min(_BAR * settings.text, 0.5 * aspect)
    half = max(reach[1] / (1.0 - foot - head), reach[0] / (aspect - bar), _SMALLEST) * (1.0 + _MARGIN)
    if settings.camera.angle:
        # what is nearer to the eye than the middle is larger
        half += float(reach[2] * np.tan(settings.camera.angle / 2))
    return float(half), np.array([-bar, head - foot, 0.0])
