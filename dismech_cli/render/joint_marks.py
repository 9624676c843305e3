"""Marks of joints: dark balls where bending passes, pale ones where bodies are hinged."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..output.frame import Topology
from ..output.read import Run
from .balls import Balls, balls_at
from .settings import Rgb, Settings

_COLORS: dict[bool, Rgb] = {True: (40, 44, 52), False: (246, 239, 214)}
# Over the radius of the thickest rod there, so that the mark stands out of it.
_OUT = 1.7


def joint_marks(run: Run, settings: Settings, least: float, sides: int) -> list[Balls]:
    """The marks of the joints that are to be shown.

    Args:
        run: The run.
        settings: What the pictures show.
        least: Least radius that is drawn [m].
        sides: Meridians.
    """
    radius = _OUT * np.maximum(_thickness(run.topology), 2.0 * least)
    marks = []
    for bends, color in _COLORS.items():
        nodes = np.array([node for node, passes in settings.joints if passes is bends], dtype=np.int64)
        if len(nodes):
            bodies = np.zeros(len(nodes), dtype=np.int64)
            marks.append(balls_at(nodes, radius[nodes], bodies, sides, color))
    return marks


def _thickness(topology: Topology) -> FloatArray:
    """Largest radius of the rods at each node, or half of a shell's thickness [m], shape (N,)."""
    out = np.zeros(len(topology.rest_positions))
    np.maximum.at(out, topology.edges, topology.edge_radius[:, None])
    np.maximum.at(out, topology.triangles, 0.5 * topology.triangle_thickness[:, None])
    return out
