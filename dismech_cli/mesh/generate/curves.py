"""Rods from formulas and tables: lines, arcs, helices, polylines."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import FloatArray
from ...errors import MeshError
from ..files.source import MAX_COORDINATE, check_count, load_text, parse_float
from ..mesh import Mesh
from ..validate import validate

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
    _check_nodes(nodes, 2, where)
    return _curve(
        np.linspace(_vector(start, "start", where), _vector(end, "end", where), nodes), False, where
    )


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
    _check_nodes(nodes, 3 if closed else 2, where)
    _check_positive(radius, "radius", where)
    turn = 2.0 * np.pi
    if closed and not abs(abs(angle) - turn) <= 1e-9 * turn:
        raise MeshError(f"{where}: angle {angle:g} rad; a closed ring needs 2 pi = {turn:.6f} rad")
    if not closed and not 0.0 < abs(angle) < turn:
        raise MeshError(f"{where}: angle {angle:g} rad; expected between 0 and 2 pi in size, or closed")
    axis = _unit(_vector(normal, "normal", where), "normal", where)
    towards = _unit(_vector(start_direction, "start_direction", where), "start_direction", where)
    first = _unit(towards - (towards @ axis) * axis, "start_direction across the normal", where)
    phi = angle * np.arange(nodes) / (nodes if closed else nodes - 1)
    points = _vector(center, "center", where) + radius * (
        np.outer(np.cos(phi), first) + np.outer(np.sin(phi), np.cross(axis, first))
    )
    return _curve(points, closed, where)


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
    _check_nodes(nodes, 2, where)
    for value, name in ((radius, "radius"), (turns, "turns")):
        _check_positive(value, name, where)
    if not (abs(pitch) <= MAX_COORDINATE and abs(phase) <= MAX_COORDINATE):
        raise MeshError(f"{where}: pitch {pitch}, phase {phase}; expected finite numbers")
    if handedness not in ("left", "right"):
        raise MeshError(f"{where}: handedness {handedness!r}; expected left or right")
    along = _unit(_vector(axis, "axis", where), "axis", where)
    reference = np.eye(3)[0 if np.hypot(along[1], along[2]) > 1e-6 else 1]
    e1 = _unit(reference - (reference @ along) * along, "axis", where)
    e2 = np.cross(along, e1)
    t = np.linspace(0.0, 1.0, nodes)
    turned = 2.0 * np.pi * turns * t
    phi = phase + turned if handedness == "right" else phase - turned
    points = (
        _vector(origin, "origin", where)
        + radius * (np.outer(np.cos(phi), e1) + np.outer(np.sin(phi), e2))
        + np.outer(pitch * turns * t, along)
    )
    return _curve(points, False, where)


def polyline(
    points: ArrayLike, *, nodes: int | None = None, spacing: float | None = None, closed: bool = False
) -> Mesh:
    """Make a rod along given points.

    Args:
        points: Corners [m], shape (K, 3). A closed rod may repeat its first point at the end.
        nodes: Number of nodes, evenly spaced along the path (corners are cut); excludes ``spacing``.
        spacing: Approximate distance between evenly spaced nodes [m]; excludes ``nodes``. With
            neither, the points are the nodes.
        closed: Whether the last node is joined to the first.

    Raises:
        MeshError: If there are too few points, two in a row coincide, or both ``nodes`` and
            ``spacing`` are given.
    """
    return _polyline(points, nodes, spacing, closed, "polyline")


def from_csv(
    path: Path,
    columns: Sequence[str | int | None] = ("x", "y", "z"),
    *,
    nodes: int | None = None,
    spacing: float | None = None,
    closed: bool = False,
) -> Mesh:
    """Make a rod along the points of a comma-separated table.

    Args:
        path: Table in metres; its first row is a header if ``columns`` has names. Rows without
            any entry are skipped.
        columns: Column of x, y and z: a name, a number from 0, or None for zeros.
        nodes: As in :func:`polyline`.
        spacing: As in :func:`polyline`.
        closed: As in :func:`polyline`.

    Raises:
        MeshError: If the table cannot be read or the points make no rod.
    """
    where = str(path)
    if len(columns) != 3 or all(column is None for column in columns):
        raise MeshError(f"{where}: columns {list(columns)}; expected one each for x, y and z")
    reader = csv.reader(load_text(path).splitlines())
    points = []
    try:
        header = next(reader, []) if any(isinstance(column, str) for column in columns) else []
        picks = [_column(column, [name.strip() for name in header], where) for column in columns]
        for row in reader:
            if not any(cell.strip() for cell in row):
                continue
            place = f"{where}:{reader.line_num}"
            if max(pick for pick in picks if pick is not None) >= len(row):
                raise MeshError(f"{place}: {len(row)} columns; expected columns {list(columns)}")
            points.append([0.0 if pick is None else parse_float(row[pick].strip(), place) for pick in picks])
    except csv.Error as error:
        raise MeshError(f"{where}:{reader.line_num}: {error}") from error
    return _polyline(np.array(points).reshape(-1, 3), nodes, spacing, closed, where)


def _column(column: str | int | None, header: list[str], where: str) -> int | None:
    """Return the number of a column."""
    if isinstance(column, str):
        if column not in header:
            raise MeshError(f"{where}:1: no column {column!r}; the header has {', '.join(header)[:200]}")
        return header.index(column)
    if column is not None and column < 0:
        raise MeshError(f"{where}: column {column}; columns count from 0")
    return column


def _polyline(points: ArrayLike, nodes: int | None, spacing: float | None, closed: bool, where: str) -> Mesh:
    corners = np.asarray(points, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1] != 3 or not (np.abs(corners) <= MAX_COORDINATE).all():
        raise MeshError(f"{where}: points of shape {corners.shape}; expected finite rows of x, y, z")
    if closed and len(corners) > 1 and (corners[0] == corners[-1]).all():
        corners = corners[:-1]
    _check_nodes(len(corners), 3 if closed else 2, where)
    if nodes is not None and spacing is not None:
        raise MeshError(f"{where}: both nodes and spacing are given; expected one of them")
    path = np.concatenate([corners, corners[:1]]) if closed else corners
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    if spacing is not None:
        nodes = _node_count(float(length[-1]), spacing, closed, where)
    if nodes is None:
        return _curve(corners, closed, where)
    _check_nodes(nodes, 3 if closed else 2, where)
    at = np.linspace(0.0, length[-1], nodes, endpoint=not closed)
    return _curve(np.stack([np.interp(at, length, path[:, k]) for k in range(3)], axis=1), closed, where)


def _node_count(length: float, spacing: float, closed: bool, where: str) -> int:
    """Return the number of nodes whose spacing comes nearest to the one asked for."""
    _check_positive(spacing, "spacing", where)
    cells = length / spacing
    if not cells < 1e15:
        raise MeshError(f"{where}: spacing {spacing:g} m over a length of {length:g} m")
    return max(round(cells), 3) if closed else max(round(cells), 1) + 1


def _curve(points: FloatArray, closed: bool, where: str) -> Mesh:
    """Join consecutive points, and the last to the first if closed."""
    index = np.arange(len(points))
    edges = np.stack([index, np.roll(index, -1)], axis=1)
    if closed:
        return validate(Mesh(nodes=points, edges=edges), where)
    ends = {"start": index[:1], "end": index[-1:]}
    return validate(Mesh(nodes=points, edges=edges[:-1], node_groups=ends), where)


def _vector(value: ArrayLike, name: str, where: str) -> FloatArray:
    vector = np.asarray(value, dtype=np.float64)
    if vector.shape != (3,) or not (np.abs(vector) <= MAX_COORDINATE).all():
        raise MeshError(f"{where}: {name} {value!r}; expected three finite numbers")
    return vector


def _unit(vector: FloatArray, name: str, where: str) -> FloatArray:
    size = float(np.linalg.norm(vector))
    if not size > 1e-12:
        raise MeshError(f"{where}: {name} has no direction; expected a vector that is not zero")
    unit: FloatArray = vector / size
    return unit


def _check_positive(value: float, name: str, where: str) -> None:
    if not 0.0 < value <= MAX_COORDINATE:
        raise MeshError(f"{where}: {name} {value}; expected a positive number")


def _check_nodes(count: int, least: int, where: str) -> None:
    if count < least:
        raise MeshError(f"{where}: {count} nodes; expected at least {least}")
    check_count(count, "nodes", where)
