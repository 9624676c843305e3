"""Material damping: viscous stresses on the strains of elastic energies (Kelvin and Voigt).

An energy e.C.e / 2 of strains e has the stress C e; here the stress is tau C de/dt on the same strains, tau
the relaxation time of the material. Rigid motions change no strain, so they meet no force. Of a natural
strain that changes in time nothing enters: the rate is that of the shape.

Parameters per stencil are the constants of the energy, then tau [s]. Strains and their derivatives come
from the text of the energies: where a stiffness is 1/s and the natural strain -s w, s a very large number,
the stress is w and the energy has the slopes and the curvature of w times the strain, to rounding. Every
kernel here returns those of the strains weighted by w, and the viscosities tau C.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..arrays import Numbers
from ..geometry.kernel import kernel
from ..geometry.triangle import azimuth_gradient
from ..geometry.vectors import norm
from ..kernels.shape import Kernel, RateKernel
from ..model.rate import ViscousStress
from ..model.stencil import StencilEnergy
from .bend_planar import BEND_PLANAR, CORNER_PLANAR, bend_planar, corner_planar
from .bend_twist import BEND_TWIST, bend_twist
from .hinge import HINGE, by_angle
from .membrane import MEMBRANE
from .metric import by_edges
from .midedge import MIDEDGE, midedge
from .midedge_averaged import MIDEDGE_AVERAGED, around, by_angles
from .rigid_joint import RIGID_JOINT, rigid_joint
from .rod_shell import ROD_BESIDE_FACE, ROD_ON_FACE, rod_on_face
from .stretch import STRETCH, STRETCH_PLANAR, along, along_planar

_S = 1e30
_SOFT = 1e-30
_NO_SLOPES = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def stretch_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of an edge in space."""
    e, stiffness, rest, tau = y[0:3], p[0], p[1], p[2]
    length = norm(e)
    slopes, curvature = along(e, length, w[0] / rest, 0.0)
    return slopes, curvature, (tau * stiffness * rest,)


@kernel
def stretch_planar_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of an edge in the plane."""
    stiffness, rest, tau = p[0], p[1], p[2]
    length = (y[0] * y[0] + y[1] * y[1]) ** 0.5
    slopes, curvature = along_planar(y[0], y[1], length, w[0] / rest, 0.0)
    return slopes, curvature, (tau * stiffness * rest,)


@kernel
def bend_planar_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of the curvature in the plane."""
    _, slopes, curvature = bend_planar(y, a, (-_S * w[0], _SOFT, 1.0))
    return slopes, curvature, (p[2] * p[0] / p[1],)


@kernel
def corner_planar_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of the curvature at a corner in the plane."""
    _, slopes, curvature = corner_planar(y, a, (-_S * w[0], _SOFT, 1.0, p[2], p[3]))
    return slopes, curvature, (p[4] * p[0] / p[1],)


@kernel
def bend_twist_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of both material curvatures and the twist."""
    k0, k1, m0 = -_S * w[0], -_S * w[1], -_S * w[2]
    soft = (k0, k1, m0, _SOFT, _SOFT, _SOFT, 1.0, p[4], p[5], p[6], p[7], p[8])
    _, slopes, curvature = bend_twist(y, a, soft)
    tau = p[9] / p[3]
    return slopes, curvature, (tau * p[0], 0.0, 0.0, tau * p[1], 0.0, tau * p[2])


@kernel
def rigid_joint_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of the three turns of a joint."""
    soft = (
        -_S * w[0], -_S * w[1], -_S * w[2], _SOFT, 0.0, 0.0, _SOFT, 0.0, _SOFT,
        p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15], p[16], 0.0, 0.0,
    )  # fmt: skip
    _, slopes, curvature = rigid_joint(y, a, soft)
    tau = p[19]
    viscosities = (tau * p[0], tau * p[1], tau * p[2], tau * p[3], tau * p[4], tau * p[5])
    return slopes, curvature, viscosities


@kernel
def rod_on_face_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of the turn between a rod and a face: its twist, and what bends beside it."""
    soft = (
        -_S * w[0], -_S * w[1], -_S * w[2], _SOFT, _SOFT, _SOFT,
        p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15],
    )  # fmt: skip
    _, slopes, curvature = rod_on_face(y, a, soft)
    tau = p[16]
    return slopes, curvature, (tau * p[0], 0.0, 0.0, tau * p[1], 0.0, tau * p[2])


@kernel
def rod_beside_face_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """The same for a face that does not end at the joint."""
    return rod_on_face_rate(y, a, p, w)


@kernel
def membrane_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of the three strains of the metric."""
    slopes, curvature = by_edges(y[0:3], y[3:6], w, _NO_SLOPES)
    tau = p[9]
    viscosities = (tau * p[3], tau * p[4], tau * p[5], tau * p[6], tau * p[7], tau * p[8])
    return slopes, curvature, viscosities


@kernel
def hinge_rate(y: Any, a: Any, p: Any, w: Any) -> Any:
    """Of the dihedral angle."""
    e, f, g = y[0:3], y[3:6], y[6:9]
    slopes, curvature = by_angle(e, f, g, azimuth_gradient(e, f), azimuth_gradient(e, g), w[0], 0.0)
    return slopes, curvature, (p[1] * p[0],)


@kernel
def midedge_rate(y: Any, x: Any, p: Any, w: Any) -> Any:
    """Of the three angles from face to edges."""
    soft = (-_S * w[0], -_S * w[1], -_S * w[2], _SOFT, 0.0, 0.0, _SOFT, 0.0, _SOFT, p[6], p[7], p[8])
    _, slopes, curvature = midedge(y, x, soft)
    tau = p[9]
    viscosities = (tau * p[0], tau * p[1], tau * p[2], tau * p[3], tau * p[4], tau * p[5])
    return slopes, curvature, viscosities


@kernel
def midedge_averaged_rate(y: Any, x: Any, p: Any, w: Any) -> Any:
    """Of the three dihedral angles, as far as they are shared."""
    slopes, curvature = by_angles(around(y), (w[0] * p[6], w[1] * p[7], w[2] * p[8]), _NO_SLOPES)
    tau = p[9]
    viscosities = (tau * p[0], tau * p[1], tau * p[2], tau * p[3], tau * p[4], tau * p[5])
    return slopes, curvature, viscosities


def _rate(elastic: Kernel, strains: int, function: Callable[[Any, Any, Any, Any], Any]) -> RateKernel:
    return RateKernel(function, elastic, strains, (*elastic.constants, "tau"))


RATES: Mapping[Kernel, RateKernel] = {
    STRETCH: _rate(STRETCH, 1, stretch_rate),
    STRETCH_PLANAR: _rate(STRETCH_PLANAR, 1, stretch_planar_rate),
    BEND_PLANAR: _rate(BEND_PLANAR, 1, bend_planar_rate),
    CORNER_PLANAR: _rate(CORNER_PLANAR, 1, corner_planar_rate),
    BEND_TWIST: _rate(BEND_TWIST, 3, bend_twist_rate),
    RIGID_JOINT: _rate(RIGID_JOINT, 3, rigid_joint_rate),
    ROD_ON_FACE: _rate(ROD_ON_FACE, 3, rod_on_face_rate),
    ROD_BESIDE_FACE: _rate(ROD_BESIDE_FACE, 3, rod_beside_face_rate),
    MEMBRANE: _rate(MEMBRANE, 3, membrane_rate),
    HINGE: _rate(HINGE, 1, hinge_rate),
    MIDEDGE: _rate(MIDEDGE, 3, midedge_rate),
    MIDEDGE_AVERAGED: _rate(MIDEDGE_AVERAGED, 3, midedge_averaged_rate),
}
"""The damping of each elastic energy."""


def damping_term(energy: StencilEnergy, relaxation_time: Numbers) -> ViscousStress:
    """The damping of an energy.

    Args:
        energy: With any natural strains: they do not enter.
        relaxation_time: tau [s], one for all stencils or one each, shape (S,).

    Raises:
        KeyError: No damping is known for its kernel.
    """
    kernel = RATES[energy.kernel]
    values = {name: energy.parameter(name) for name in energy.kernel.constants}
    return ViscousStress.of(
        f"{energy.name} damping",
        kernel,
        energy.dofs,
        {**values, "tau": relaxation_time},
        energy.auxiliaries[:, : kernel.auxiliaries],
    )
