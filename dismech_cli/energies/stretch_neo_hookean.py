"""Axial stretching of an edge of rubber: neo-Hookean, incompressible.

W = mu/2 A L (lambda^2 + 2/lambda - 3), lambda = |e| / L on the natural length L = l (1 + eps0), with
the tension mu A (lambda - 1/lambda^2); mu = E / 3, and the section A thins as the edge lengthens. Edges
that are not of rubber stand among the others with their own stiffness, as in :mod:`.stretch`.

Parameters per stencil, after the natural strain eps0 [1]: EA [N] of what is linear, muA [N] of rubber,
rest length l [m].
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..geometry.kernel import kernel
from ..geometry.vectors import norm
from ..kernels.shape import Kernel
from .stretch import along, along_planar, axial


@kernel
def axial_neo_hookean(length: Any, natural: Any, stiffness: Any, rubber: Any, rest: Any) -> Any:
    """Return energy [J], tension N [N] and dN/d|e| [N/m]."""
    energy, tension, slope = axial(length, natural, stiffness, rest)
    own = rest * (1.0 + natural)
    stretch = length / own
    strain = stretch - 1.0
    by = 1.0 / stretch
    return (
        energy + 0.5 * rubber * own * strain * strain * (stretch + 2.0) * by,
        tension + rubber * strain * (1.0 + by + by * by),
        slope + rubber * (1.0 + 2.0 * by * by * by) / own,
    )


@kernel
def stretch_neo_hookean(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vector, in space."""
    e = y[0:3]
    length = norm(e)
    energy, tension, slope = axial_neo_hookean(length, p[0], p[1], p[2], p[3])
    gradient, hessian = along(e, length, tension, slope)
    return energy, gradient, hessian


@kernel
def stretch_neo_hookean_planar(y: Any, a: Any, p: Any) -> Any:
    """Energy, gradient and packed Hessian with respect to the edge vector, in the plane."""
    length = np.sqrt(y[0] * y[0] + y[1] * y[1])
    energy, tension, slope = axial_neo_hookean(length, p[0], p[1], p[2], p[3])
    gradient, hessian = along_planar(y[0], y[1], length, tension, slope)
    return energy, gradient, hessian


STRETCH_NEO_HOOKEAN = Kernel(
    stretch_neo_hookean,
    dimension=3,
    nodes=2,
    vectors=((0, 1),),
    naturals=("eps",),
    constants=("EA", "muA", "length"),
    scales=(("EA", "muA"),),
)
STRETCH_NEO_HOOKEAN_PLANAR = replace(STRETCH_NEO_HOOKEAN, function=stretch_neo_hookean_planar, dimension=2)
