"""Where the camera stands so that the motion fills the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..output.read import Run
from .settings import Settings, View

# Room around the motion, as a share of its size; the labels lie in it.
_MARGIN = 0.16

_COLOR_BAR_STRIP = 0.16  # of the height of the picture
_LEAST_RADIUS = 0.8  # pixel

_OBLIQUE = np.array([0.62, -1.0, 0.55])

# Direction towards the viewer and the upward direction of each view.
_DIRECTIONS: dict[View, tuple[FloatArray, FloatArray]] = {
    "xy": (np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])),
    "xz": (np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0])),
    "yz": (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])),
    "iso": (_OBLIQUE, np.array([0.0, 0.0, 1.0])),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Framing:
    """A parallel projection for every frame.

    Attributes:
        basis: Rows right, up, towards the viewer; shape (3, 3).
        centers: Middle of the picture in world coordinates [m], shape (F, 3).
        half_height: Half the height of the picture [m].
        depth: Half the depth of the scene along the line of sight [m].
        floor: Lowest z of the motion [m].
    """

    basis: FloatArray
    centers: FloatArray
    half_height: float
    depth: float
    floor: float

    def pixel(self, size: tuple[int, int]) -> float:
        """Width of one pixel [m] in a picture of ``size``."""
        return 2.0 * self.half_height / size[1]

    def least_radius(self, size: tuple[int, int]) -> float:
        """Radius [m] below which a rod would vanish between the pixels."""
        return _LEAST_RADIUS * self.pixel(size)


def view_basis(view: View) -> FloatArray:
    """Unit vectors right, up and towards the viewer, as rows."""
    towards, upward = _DIRECTIONS[view]
    towards = towards / np.linalg.norm(towards)
    right = np.cross(upward, towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])


def frame_motion(run: Run, settings: Settings) -> Framing:
    """Fit the camera to all frames of a run.

    Positions that are not finite, as a failed run may leave, are passed over.
    """
    basis = view_basis(settings.view)
    lower = np.zeros((len(run), 3))
    upper = np.zeros((len(run), 3))
    floor = np.inf
    for index, positions in enumerate(run.positions):
        finite = positions[np.isfinite(positions).all(axis=1)]
        if len(finite):
            seen = finite @ basis.T
            lower[index], upper[index] = seen.min(axis=0), seen.max(axis=0)
            floor = min(floor, float(finite[:, 2].min()))
    topology = run.topology
    thickest = max(topology.edge_radius.max(initial=0.0), topology.triangle_thickness.max(initial=0.0) / 2)
    if settings.camera == "fixed":
        lower[:], upper[:] = lower.min(axis=0, initial=np.inf), upper.max(axis=0, initial=-np.inf)
    half = ((upper - lower) / 2).max(axis=0, initial=0.0) + thickest
    # The colour bar stands in a strip of its own on the left.
    strip = 0.0 if settings.color_by is None else _COLOR_BAR_STRIP
    aspect = settings.size[0] / settings.size[1]
    half_height = float(max(half[1], half[0] / (aspect - strip), 1e-12)) * (1.0 + _MARGIN)
    middles = (lower + upper) / 2 - np.array([strip * half_height, 0.0, 0.0])
    return Framing(
        basis=basis,
        centers=middles @ basis,
        half_height=half_height,
        depth=float(half[2]),
        floor=float(floor - thickest) if np.isfinite(floor) else 0.0,
    )
