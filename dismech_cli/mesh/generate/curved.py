"""Shells from formulas, curved: sheets rolled to panels of cylinders and spheres, or all around."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, distinct, union
from ...errors import MeshError
from ..mesh import Mesh
from ..validate import validate
from .sheets import Pattern, sheet

_FULL = 2.0 * np.pi
# An angle this close to a full turn is one: 360 degrees in radians carries a rounding error.
_CLOSED = 1e-12


def cylinder(
    radius: float, length: float, angle: float, divisions: int, pattern: Pattern = Pattern.EQUILATERAL
) -> Mesh:
    """Roll a sheet around +z: z from 0 to ``length``, azimuths from +x, normals outward.

    Args:
        radius: Radius [m].
        length: Size along the axis [m].
        angle: Azimuth of the last straight side [rad], at most a full turn, which closes the tube.
        divisions: Number of edges along the length; those around follow.
        pattern: How the triangles are laid, see :func:`sheet`.

    Returns:
        Mesh with node groups ``left`` (z = 0), ``right`` (z = length), ``bottom`` (azimuth 0),
        ``top`` (azimuth ``angle``) and ``rim``.

    Raises:
        MeshError: If sizes are not positive, the angle is over a full turn, there would be too many
            nodes, or the triangles do not meet at the seam of a tube.
    """
    flat = sheet(length, _arc("cylinder", radius, angle), divisions, pattern)
    azimuth = flat.nodes[:, 1] * (angle / flat.nodes[:, 1].max())
    nodes = np.column_stack((radius * np.cos(azimuth), radius * np.sin(azimuth), flat.nodes[:, 0]))
    # a sheet's normal, axis x azimuth, points inward
    rolled = replace(flat, nodes=nodes, triangles=flat.triangles[:, [0, 2, 1]])
    return _joined(rolled, flat.nodes[:, 0], angle, "cylinder")


def sphere(
    radius: float,
    polar: tuple[float, float],
    angle: float,
    divisions: int,
    pattern: Pattern = Pattern.EQUILATERAL,
) -> Mesh:
    """Bend a sheet to the part of a sphere around the origin between two parallels, normals outward.

    Args:
        radius: Radius [m].
        polar: Angles from +z of both parallels [rad], ascending, inside (0, pi).
        angle: Azimuth from +x of the last meridian [rad], at most a full turn, which closes the zone.
        divisions: Number of edges along a meridian; those around follow at the widest parallel.
        pattern: How the triangles are laid, see :func:`sheet`.

    Returns:
        Mesh with node groups ``left`` (first parallel), ``right`` (second parallel), ``bottom``
        (azimuth 0), ``top`` (azimuth ``angle``) and ``rim``.

    Raises:
        MeshError: If sizes are not positive, the angles are out of range, there would be too many
            nodes, or the triangles do not meet at the seam of a closed zone.
    """
    first, last = polar
    if not 0.0 < first < last < np.pi:
        raise MeshError(f"sphere: polar angles {first} and {last} rad; expected 0 < first < second < pi")
    widest = 1.0 if first <= 0.5 * np.pi <= last else max(np.sin(first), np.sin(last))
    flat = sheet(radius * (last - first), _arc("sphere", radius * widest, angle), divisions, pattern)
    along, around = flat.nodes[:, 0], flat.nodes[:, 1]
    theta = first + along * ((last - first) / along.max())
    azimuth = around * (angle / around.max())
    nodes = np.column_stack((np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)))
    return _joined(replace(flat, nodes=radius * nodes), along, angle, "sphere")


def _arc(where: str, radius: float, angle: float) -> float:
    if not 0.0 < angle <= _FULL * (1.0 + _CLOSED):
        raise MeshError(f"{where}: angle {angle} rad; expected a positive one of at most a full turn")
    return radius * angle


def _joined(mesh: Mesh, along: FloatArray, angle: float, where: str) -> Mesh:
    """Validate; all around, first make one line of nodes of the first and the last side.

    Args:
        mesh: The bent sheet.
        along: Place of each node along the seam [m], shape (N,).
        angle: Azimuth of the last side [rad].
        where: For messages.
    """
    if angle < _FULL * (1.0 - _CLOSED):
        return validate(mesh, where)
    groups = mesh.node_groups
    first, last = (side[np.argsort(along[side])] for side in (groups["bottom"], groups["top"]))
    if len(first) != len(last) or not np.array_equal(along[first], along[last]):
        raise MeshError(
            f"{where}: an odd number of rows of equilateral triangles does not close; change the divisions "
            "or take another pattern"
        )
    target = np.arange(len(mesh.nodes))
    target[last] = first
    kept = distinct(target)
    number = np.zeros(len(target), dtype=np.int64)
    number[kept] = np.arange(len(kept))
    number = number[target]
    names = {name: distinct(number[group]) for name, group in groups.items()}
    names["rim"] = union(names["left"], names["right"])
    closed = replace(mesh, nodes=mesh.nodes[kept], triangles=number[mesh.triangles], node_groups=names)
    return validate(closed, where)
