"""A heavy cantilever at the ends of the range of inputs, at rest and in time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Final

import numpy as np

from dismech_cli.session.report import Report

from .cell import Cell, Check, Deck, near
from .rod_balance import Rod

MODULUS: Final = (1e2, 1e4, 1e6, 1e9, 1e12)
RADIUS: Final = (1e-6, 1e-4, 1e-3, 1e-2, 1.0)
DENSITY: Final = (1.0, 1e3, 2e4)
ASPECT: Final = (10.0, 1e2, 1e3, 1e4, 1e5)
GRAVITY: Final = (0.0, 1e-3, 9.81, 1e3)
STEP: Final = (1e-7, 1e-5, 1e-3, 1e-2, 0.1, 1.0)
AXES: Final = {
    "modulus": MODULUS,
    "radius": RADIUS,
    "density": DENSITY,
    "aspect": ASPECT,
    "gravity": GRAVITY,
    "dt": STEP,
}
NODES: Final = 21
STEPS: Final = 5
# Newton's tolerance in time is 1e-5 of the largest forces; theirs and those here are not counted alike.
_BALANCED: Final = 1e-4


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """What is put to its extremes.

    Attributes:
        modulus: Young's [Pa].
        radius: Of the section [m].
        density: Mass per volume [kg/m^3].
        aspect: Length over radius.
        gravity: Down z [m/s^2].
        dt: The step [s]; None at rest.
    """

    modulus: float
    radius: float
    density: float
    aspect: float
    gravity: float
    dt: float | None

    @property
    def rod(self) -> Rod:
        """For the balance of forces."""
        return Rod.round(
            modulus=self.modulus,
            radius=self.radius,
            density=self.density,
            length=self.aspect * self.radius,
            nodes=NODES,
            gravity=self.gravity,
        )


BASE: Final = Inputs(modulus=1e6, radius=1e-3, density=1e3, aspect=1e2, gravity=9.81, dt=1e-2)
SINGLE: Final = [
    (axis, value) for axis, values in AXES.items() for value in values if value != getattr(BASE, axis)
]
"""One input at an extreme, all others moderate."""


def cantilever(inputs: Inputs, *, integrator: str = "implicit_euler", dimension: int = 2) -> Deck:
    """A cantilever, in time or at rest."""
    radius, dt = inputs.radius, inputs.dt
    numerics: dict[str, Any] = {"integrator": {"type": "static", "load_steps": 5}}
    if dt is not None:
        numerics = {"integrator": {"type": integrator}, "dt": dt, "t_end": STEPS * dt}
    line = {"shape": "line", "from": [0, 0, 0], "to": [inputs.aspect * radius, 0, 0], "nodes": NODES}
    material = {"youngs_modulus": inputs.modulus, "poisson_ratio": 0.5, "density": inputs.density}
    return {
        "schema_version": 1,
        "name": "extreme",
        "dimension": dimension,
        "materials": {"m": material},
        "geometry": [{"type": "rod", "name": "rod", "material": "m", "radius": radius, "generate": line}],
        "motions": [{"type": "clamp", "where": "rod.start"}],
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -inputs.gravity]}],
        "numerics": numerics,
        "output": {"every": dt or 0.2, "fields": ["velocity"]},
    }


def single(integrator: str) -> Iterator[Cell]:
    """One extreme input, in time."""
    for axis, value in SINGLE:
        inputs = replace(BASE, **{axis: value})
        right = in_balance if integrator == "implicit_euler" else no_energy_made
        yield Cell(
            f"one extreme, {integrator}",
            f"{axis} {value:g}",
            cantilever(inputs, integrator=integrator),
            right(inputs.rod, inputs.dt),
        )


def single_at_rest(dimension: int) -> Iterator[Cell]:
    """One extreme input, static."""
    for axis, value in SINGLE:
        if axis != "dt":
            inputs = replace(BASE, dt=None, **{axis: value})
            yield Cell(
                f"one extreme, static, {dimension}D",
                f"{axis} {value:g}",
                cantilever(inputs, dimension=dimension),
                in_balance(inputs.rod, None),
            )


def corners(modulus: float, radius: float, aspect: float) -> Iterator[Cell]:
    """The product of the extremes of the other inputs, in time and static."""
    for density, gravity, dt in product(DENSITY[::2], GRAVITY[1::2], (*STEP[::3], STEP[-1], None)):
        inputs = Inputs(
            modulus=modulus, radius=radius, density=density, aspect=aspect, gravity=gravity, dt=dt
        )
        label = f"modulus {modulus:g}, radius {radius:g}, aspect {aspect:g}, density {density:g}"
        label += f", gravity {gravity:g}"
        yield Cell(
            "corner, static" if dt is None else "corner, implicit_euler",
            label if dt is None else f"{label}, dt {dt:g}",
            cantilever(inputs),
            in_balance(inputs.rod, dt),
        )


def all_corners() -> Iterator[Cell]:
    """The whole product."""
    for modulus, radius, aspect in product(MODULUS, RADIUS, ASPECT):
        yield from corners(modulus, radius, aspect)


def slender_sag() -> Iterator[Cell]:
    """At equal weight over stiffness, rho g A L^3/EI = 5, all slender cantilevers hang alike."""
    for modulus, aspect in product((1e3, 1e7, 1e12), ASPECT):
        radius, density = 1e-3, 1e3
        gravity = 5.0 * modulus * radius**2 / (4.0 * density * (aspect * radius) ** 3)
        inputs = Inputs(
            modulus=modulus, radius=radius, density=density, aspect=aspect, gravity=gravity, dt=None
        )
        # 21 nodes: discretisation 1e-3; a thick rod also stretches, by 5 (r/L)^2/8 at most
        share = 2e-3 + 5.0 / aspect**2

        def check(report: Report, length: float = aspect * radius, share: float = share) -> str:
            drop = -report.frames[-1].positions[-1, 2] / length
            return near(drop, 0.4959050, share / 0.4959050, "sag over length")

        yield Cell(
            "slender, equal weight", f"modulus {modulus:g}, aspect {aspect:g}", cantilever(inputs), check
        )


def in_balance(rod: Rod, dt: float | None) -> Check:
    """Every frame is in balance: at rest, or in steps of implicit Euler from rest."""

    def check(report: Report) -> str:
        x = np.array([frame.positions[:, [0, 2]] for frame in report.frames])
        if max(np.abs(frame.positions[:, 1]).max() for frame in report.frames) > 0.0:
            return "it left its plane"
        if dt is None:
            found = rod.unbalanced(x[-1])
        elif report.outcome.counters["cuts"]:
            # between the parts of a step there is no frame
            found = 0.0
        else:
            v = np.diff(x, axis=0, prepend=x[:1]) / dt
            found = max(rod.unbalanced(x[k + 1], v=v[k + 1] - v[k], dt=dt) for k in range(STEPS))
        return "" if found <= _BALANCED else f"forces out of balance by {found:.2g}"

    return both(check, no_energy_made(rod, dt))


def both(one: Check, other: Check) -> Check:
    """What either finds wrong."""
    return lambda report: one(report) or other(report)


def no_energy_made(rod: Rod, dt: float | None) -> Check:
    """From rest under its weight no cantilever ever has more energy than it started with, but for "
    "rounding."""
    # of positions, of which velocities are made
    slip = 0.0 if dt is None else 8.0 * float(np.finfo(float).eps) * rod.length / dt
    rounding = 1e-12 * rod.axial * rod.length + 0.5 * float(rod.masses.sum()) * slip**2

    def check(report: Report) -> str:
        for frame in report.frames[1:]:
            x, v = frame.positions[:, [0, 2]], frame.fields["velocity"]
            kinetic = float(0.5 * rod.masses @ (v * v).sum(axis=1))
            elastic = float(rod.elastic(x[None].astype(complex)).real[0])
            fallen = float(-rod.gravity * rod.masses @ x[:, 1])
            if kinetic + elastic > fallen * 1.001 + rounding:
                return f"energy of {kinetic + elastic:.3g} J out of {fallen:.3g} J"
        return ""

    return check
