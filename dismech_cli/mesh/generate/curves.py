"""Rods from formulas: lines, arcs, helices."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ...errors import MeshError
from ..limits import MAX_COORDINATE
from ..mesh import Mesh
from .chain import chain
from .checks import check_nodes, check_positive, unit, vector

Handedness = Literal["left", "right"]


def line(start: ArrayLike, end: ArrayLike, nodes: int) -> Mesh:
    """Make a straight rod with evenly spaced nodes.

    Args:
        start: Position of the first node [m], shape (3,).
        end: Position of the last node [m], shape (3,).
        nodes: Number of nodes, at least 2.

    Raises:
        MeshError: If the rod has no length or too few nodes.
    """
    where = "line"
    check_nodes(nodes, 2, where)
    return chain(np.linspace(vector(start, "start", where), vector(end, "end", where), nodes), False, where)


def arc(
    center: ArrayLike,
    radius: float,
    normal: ArrayLike,
    start_direction: ArrayLike,
    angle: float,
    nodes: int,
    *,
    closed: bool = False,
) -> Mesh:
    """Make a circular rod, or a ring.

    Args:
        center: Centre of the circle [m], shape (3,).
        radius: Radius [m].
        normal: Axis about which the angle is counted, right-handed, shape (3,).
        start_direction: From the centre towards the first node, made normal to the axis, shape (3,).
        angle: Angle swept [rad], negative for the other sense; 2 pi in size for a ring.
        nodes: Number of nodes; a ring does not repeat its first node.
        closed: Whether the last node is joined to the first.

    Raises:
        MeshError: If the sizes are not positive, the directions parallel, or the angle does not fit.
    """
    where = "arc"
    check_nodes(nodes, 3 if closed else 2, where)
    check_positive(radius, "radius", where)
    turn = 2.0 * np.pi
    if closed and not abs(abs(angle) - turn) <= 1e-9 * turn:
        raise MeshError(f"{where}: angle {angle:g} rad; a closed ring needs 2 pi = {turn:.6f} rad")
    if not closed and not 0.0 < abs(angle) < turn:
        raise MeshError(f"{where}: angle {angle:g} rad; expected between 0 and 2 pi in size, or closed")
    axis = unit(vector(normal, "normal", where), "normal", where)
    towards = unit(vector(start_direction, "start_direction", where), "start_direction", where)
    first = unit(towards - (towards @ axis) * axis, "start_direction across the normal", where)
    phi = angle * np.arange(nodes) / (nodes if closed else nodes - 1)
    points = vector(center, "center", where) + radius * (
        np.outer(np.cos(phi), first) + np.outer(np.sin(phi), np.cross(axis, first))
    )
    return chain(points, closed, where)


def helix(
    origin: ArrayLike,
    axis: ArrayLike,
    radius: float,
    pitch: float,
    turns: float,
    nodes: int,
    *,
    handedness: Handedness = "right",
    phase: float = 0.0,
) -> Mesh:
    r"""Make a helical rod with nodes evenly spaced along it.

    With t from 0 to 1 the nodes are at origin + R (cos(phi) e1 + sin(phi) e2) + pitch turns t axis,
    phi = phase +- 2 pi turns t (+ for right-handed). The zero direction e1 of the angle is the x
    axis made normal to the helix axis, or the y axis where the helix axis is parallel to x; and
    e2 = axis x e1. For an axis along +z or -z, phase is thus measured from the x axis, towards +y
    for +z and towards -y for -z.

    Args:
        origin: Point of the axis at the height of the first node [m], shape (3,).
        axis: Direction in which the helix advances, shape (3,).
        radius: Radius R of the centreline [m].
        pitch: Advance per turn [m].
        turns: Number of turns.
        nodes: Number of nodes, at least 2.
        handedness: "right" turns right-handed about the axis as it advances.
        phase: Angle of the first node [rad].

    Raises:
        MeshError: If the sizes are not positive or the axis is zero.
    """
    where = "helix"
    check_nodes(nodes, 2, where)
    for value, name in ((radius, "radius"), (turns, "turns")):
        check_positive(value, name, where)
    if not (abs(pitch) <= MAX_COORDINATE and abs(phase) <= MAX_COORDINATE):
        raise MeshError(f"{where}: pitch {pitch}, phase {phase}; expected finite numbers")
    if handedness not in ("left", "right"):
        raise MeshError(f"{where}: handedness {handedness!r}; expected left or right")
    along = unit(vector(axis, "axis", where), "axis", where)
    reference = np.eye(3)[0 if np.hypot(along[1], along[2]) > 1e-6 else 1]
    e1 = unit(reference - (reference @ along) * along, "axis", where)
    e2 = np.cross(along, e1)
    t = np.linspace(0.0, 1.0, nodes)
    turned = 2.0 * np.pi * turns * t
    phi = phase + turned if handedness == "right" else phase - turned
    points = (
        vector(origin, "origin", where)
        + radius * (np.outer(np.cos(phi), e1) + np.outer(np.sin(phi), e2))
        + np.outer(pitch * turns * t, along)
    )
    return chain(points, False, where)
