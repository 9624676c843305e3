"""First directors of rod edges at rest: t x y, then parallel transport in edge order.

The rule is fixed so that results do not depend on chance. In the plane normal to an edge, with any unit
normal d as the real axis and t x d as the imaginary one, a director is a complex number of modulus one,
and parallel transport to the next edge multiplies it by another. The transports along a chain are
therefore one cumulative product, and directors stay normal to their edges however long it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from ..geometry.rotation import orthonormal_to, parallel_transport
from ..geometry.vectors import combine, cross, dot, norm

# Neighbours within this angle [rad] of a fold define no plane of rotation.
_FOLD = 1e-10


def space_parallel(tangents: FloatArray, given: FloatArray) -> FloatArray:
    """First directors at rest: parallel transport along the edge order.

    The start is t x y (t x -z where that vanishes); a column of ``given`` restarts the transport. An
    edge that folds back onto the one before it keeps its director.

    Args:
        tangents: Unit tangents, shape (3, E).
        given: Directors to start from, NaN columns where there is none, shape (3, E).

    Returns:
        Unit directors normal to the tangents, shape (3, E).
    """
    count = tangents.shape[1]
    if count == 0:
        return np.empty((3, 0))
    start = np.isfinite(given[0])
    guide = given.copy()
    if not start[0]:
        guide[:, 0] = _first(tangents[:, 0])
        start[0] = True
    before, after = tangents[:, :-1], tangents[:, 1:]
    # transport from t to u is that from -t to -u: behind a fold, walk the edges the other way
    folds = (norm(cross(before, after)) < _FOLD) & (dot(before, after) < 0.0)
    walk = tangents * np.cumprod(np.concatenate(([1.0], np.where(folds, -1.0, 1.0))))
    real = _normals(walk)
    imaginary = cross(walk, real)
    moved = parallel_transport(real[:, :-1], walk[:, :-1], walk[:, 1:])
    turns = _unit(dot(real[:, 1:], moved) + 1j * dot(imaginary[:, 1:], moved))
    turned = _unit(np.multiply.accumulate(np.concatenate(([1.0 + 0.0j], turns))))
    starts = np.flatnonzero(start)
    across = orthonormal_to(guide[:, starts], walk[:, starts])
    phase = dot(real[:, starts], across) + 1j * dot(imaginary[:, starts], across)
    latest = np.cumsum(start) - 1
    director = turned * (phase / turned[starts])[latest]
    out: FloatArray = orthonormal_to(combine(director.real, real, director.imag, imaginary), tangents)
    return out


def _first(t: FloatArray) -> FloatArray:
    """Director of an edge with nothing before it, of any length, shape (3,)."""
    a = np.cross(t, (0.0, 1.0, 0.0))
    return np.cross(t, (0.0, 0.0, -1.0)) if np.linalg.norm(a) < 1e-6 else a


def _normals(tangents: FloatArray) -> FloatArray:
    """A unit normal of each tangent, from the axis most across it, shape (3, E)."""
    axes = np.zeros_like(tangents)
    axes[np.argmin(np.abs(tangents), axis=0), np.arange(tangents.shape[1])] = 1.0
    out: FloatArray = orthonormal_to(axes, tangents)
    return out


def _unit(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Complex numbers of modulus one."""
    out: NDArray[np.complex128] = z / np.abs(z)
    return out
