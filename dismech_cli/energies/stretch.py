"""Axial stretching of an edge: E = EA l (eps - eps0)^2 / 2, eps = |e|/l - 1.

Parameters per stencil, after the natural strain eps0 [1]: EA [N], rest length l [m].
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..geometry.kernel import kernel
from ..geometry.vectors import add_identity, norm, scale, scale_symmetric, self_outer
from ..kernels.shape import Kernel


@kernel
def axial(length: Any, natural: Any, stiffness: Any, rest: Any) -> Any:
    """Return energy [J], tension N [N] and dN/d|e| [N/m]."""
    strain = length / rest - 1.0 - natural
    return 0.5 * stiffness * rest * strain * strain, stiffness * strain, stiffness / rest


@kernel
def along(e: Any, length: Any, tension: Any, slope: Any) -> Any:
    """Gradient and packed Hessian to the edge vector e, in space, of an energy of its length."""
    t = scale(1.0 / length, e)
    geometric = tension / length
    hessian = add_identity(geometric, scale_symmetric(slope - geometric, self_outer(t)))
    return scale(tension, t), hessian


@kernel
def along_planar(x: Any, y: Any, length: Any, tension: Any, slope: Any) -> Any:
    """The same in the plane, of the edge vector (x, y)."""
    tx, ty = x / length, y / length
    geometric = tension / length
    w = slope - geometric
    return (tension * tx, tension * ty), (w * tx * tx + geometric, w * tx * ty, w * ty * ty + geometric)


@kernel
def stretch(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vector, in space."""
    e = y[0:3]
    length = norm(e)
    energy, tension, slope = axial(length, p[0], p[1], p[2])
    gradient, hessian = along(e, length, tension, slope)
    return energy, gradient, hessian


@kernel
def stretch_planar(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vector, in the plane."""
    length = np.sqrt(y[0] * y[0] + y[1] * y[1])
    energy, tension, slope = axial(length, p[0], p[1], p[2])
    gradient, hessian = along_planar(y[0], y[1], length, tension, slope)
    return energy, gradient, hessian


STRETCH = Kernel(
    stretch,
    dimension=3,
    nodes=2,
    vectors=((0, 1),),
    naturals=("eps",),
    constants=("EA", "length"),
    scales=(("EA",),),
)
STRETCH_PLANAR = replace(STRETCH, function=stretch_planar, dimension=2)
