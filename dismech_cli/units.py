"""Physical quantities and the units that they are written in.

A dimension is the exponents of metre, kilogram, second and radian. The radian counts as a
dimension so that an angle cannot pass for a plain ratio, nor rad/s for Hz.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from .frozen import frozen


class Dimension(NamedTuple):
    """Exponents of the base units."""

    m: int = 0
    kg: int = 0
    s: int = 0
    rad: int = 0

    def times(self, other: Dimension, power: int = 1) -> Dimension:
        """This dimension multiplied by ``other ** power``."""
        return Dimension(*(a + power * b for a, b in zip(self, other, strict=True)))


@frozen
class Kind:
    """A physical quantity that a key of the scenario may ask for.

    Attributes:
        phrase: With its article, for messages: "a pressure".
        unit: SI unit as written, ``"1"`` if a plain number.
        dimension: Exponents of the base units.
        also: Other dimensions taken for it.
    """

    phrase: str
    unit: str
    dimension: Dimension
    also: tuple[Dimension, ...] = ()


KINDS: Final[dict[str, Kind]] = {
    "ratio": Kind("a plain number", "1", Dimension()),
    "length": Kind("a length", "m", Dimension(m=1)),
    "area": Kind("an area", "m^2", Dimension(m=2)),
    "torsion constant": Kind("a torsion constant", "m^4", Dimension(m=4)),
    "time": Kind("a time", "s", Dimension(s=1)),
    "frequency": Kind("a frequency", "Hz", Dimension(s=-1)),
    "angle": Kind("an angle", "rad", Dimension(rad=1)),
    "curvature": Kind("a curvature", "1/m", Dimension(m=-1), (Dimension(m=-1, rad=1),)),
    "twist rate": Kind("a twist per length", "rad/m", Dimension(m=-1, rad=1), (Dimension(m=-1),)),
    "strain": Kind(
        "a strain, a curvature, a twist per length or an angle",
        "1",
        Dimension(),
        (Dimension(m=-1), Dimension(m=-1, rad=1), Dimension(rad=1)),
    ),
    "strain rate": Kind(
        "a rate of strain, curvature, twist per length or angle",
        "1/s",
        Dimension(s=-1),
        (Dimension(m=-1, s=-1), Dimension(m=-1, s=-1, rad=1), Dimension(s=-1, rad=1)),
    ),
    "rate of ratio": Kind("a rate of strain", "1/s", Dimension(s=-1)),
    "rate of curvature": Kind(
        "a rate of curvature", "1/m/s", Dimension(m=-1, s=-1), (Dimension(m=-1, s=-1, rad=1),)
    ),
    "rate of twist rate": Kind(
        "a rate of twist per length", "rad/m/s", Dimension(m=-1, s=-1, rad=1), (Dimension(m=-1, s=-1),)
    ),
    "rate of angle": Kind("an angular velocity", "rad/s", Dimension(s=-1, rad=1)),
    "velocity": Kind("a velocity", "m/s", Dimension(m=1, s=-1)),
    "angular velocity": Kind("an angular velocity", "rad/s", Dimension(s=-1, rad=1)),
    "acceleration": Kind("an acceleration", "m/s^2", Dimension(m=1, s=-2)),
    "mass": Kind("a mass", "kg", Dimension(kg=1)),
    "density": Kind("a density", "kg/m^3", Dimension(m=-3, kg=1)),
    "mass per length": Kind("a mass per length", "kg/m", Dimension(m=-1, kg=1)),
    "inertia per length": Kind("a rotary inertia per length", "kg*m", Dimension(m=1, kg=1)),
    "force": Kind("a force", "N", Dimension(1, 1, -2)),
    "force per length": Kind("a force per length", "N/m", Dimension(0, 1, -2)),
    "pressure": Kind("a pressure", "Pa", Dimension(-1, 1, -2)),
    "moment": Kind("a moment", "N*m", Dimension(2, 1, -2), (Dimension(2, 1, -2, -1),)),
    "moment per length": Kind("a moment per length", "N*m/m", Dimension(1, 1, -2)),
    "energy": Kind("an energy", "J", Dimension(2, 1, -2)),
    "bending stiffness": Kind("a bending stiffness", "N*m^2", Dimension(3, 1, -2)),
    "damping per area": Kind("a damping per area", "N*s/m^3", Dimension(-2, 1, -1)),
    "viscosity": Kind("a viscous coefficient", "N*s/m^2", Dimension(-1, 1, -1)),
}

_NEWTON = KINDS["force"].dimension
_PASCAL = KINDS["pressure"].dimension
_JOULE = KINDS["energy"].dimension

_PREFIXES: Final = {
    "n": 1e-9,
    "u": 1e-6,
    "µ": 1e-6,
    "μ": 1e-6,
    "m": 1e-3,
    "": 1.0,
    "k": 1e3,
    "M": 1e6,
    "G": 1e9,
    "T": 1e12,
}
_PREFIXED: Final[dict[str, tuple[float, Dimension]]] = {
    "m": (1.0, Dimension(m=1)),
    "g": (1e-3, Dimension(kg=1)),
    "s": (1.0, Dimension(s=1)),
    "N": (1.0, _NEWTON),
    "Pa": (1.0, _PASCAL),
    "J": (1.0, _JOULE),
    "W": (1.0, Dimension(2, 1, -3)),
    "Hz": (1.0, Dimension(s=-1)),
    "rad": (1.0, Dimension(rad=1)),
}
UNITS: Final[dict[str, tuple[float, Dimension]]] = {
    **{p + u: (f * v, d) for u, (v, d) in _PREFIXED.items() for p, f in _PREFIXES.items()},
    "cm": (1e-2, Dimension(m=1)),
    "dm": (1e-1, Dimension(m=1)),
    "in": (0.0254, Dimension(m=1)),
    "ft": (0.3048, Dimension(m=1)),
    "t": (1e3, Dimension(kg=1)),
    "lb": (0.45359237, Dimension(kg=1)),
    "lbf": (4.4482216152605, _NEWTON),
    "psi": (4.4482216152605 / 0.0254**2, _PASCAL),
    "min": (60.0, Dimension(s=1)),
    "h": (3600.0, Dimension(s=1)),
    "bar": (1e5, _PASCAL),
    "deg": (math.pi / 180, Dimension(rad=1)),
    "°": (math.pi / 180, Dimension(rad=1)),
    "%": (1e-2, Dimension()),
    "1": (1.0, Dimension()),
}
