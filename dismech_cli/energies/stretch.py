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
def _axial(length: Any, natural: Any, stiffness: Any, rest: Any) -> Any:
    """Return energy [J], tension N [N] and dN/d|e| [N/m]."""
    strain = length / rest - 1.0 - natural
    return 0.5 * stiffness * rest * strain * strain, stiffness * strain, stiffness / rest


@kernel
def stretch(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vector, in space."""
    e = y[0:3]
    length = norm(e)
    t = scale(1.0 / length, e)
    energy, tension, slope = _axial(length, p[0], p[1], p[2])
    geometric = tension / length
    hessian = add_identity(geometric, scale_symmetric(slope - geometric, self_outer(t)))
    return energy, scale(tension, t), hessian


@kernel
def stretch_planar(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vector, in the plane."""
    length = np.sqrt(y[0] * y[0] + y[1] * y[1])
    tx, ty = y[0] / length, y[1] / length
    energy, tension, slope = _axial(length, p[0], p[1], p[2])
    geometric = tension / length
    w = slope - geometric
    return (
        energy,
        (tension * tx, tension * ty),
        (w * tx * tx + geometric, w * tx * ty, w * ty * ty + geometric),
    )


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
