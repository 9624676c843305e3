"""Cantilevers under a follower force at the tip: bent by one across them, fluttering under one along them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

from dismech_cli.arrays import FloatArray


@dataclass(frozen=True)
class Bent:
    """Tip of a clamped inextensible rod of unit length, first along x, under a force turning with its tip."""

    x: float
    z: float
    rotation: float


def bent_by_follower(alpha: float) -> Bent:
    """Tip for alpha = P L^2 / EI, the force along z at rest.

    The internal force has the direction of the normal at the tip everywhere, so psi = theta(L) - theta
    obeys psi'' = alpha cos(psi) over the distance from the tip, where psi = psi' = 0: no shooting is needed.
    """

    def slopes(_: float, y: FloatArray) -> list[float]:
        psi, rate = y[:2]
        return [rate, alpha * np.cos(psi), np.cos(psi), np.sin(psi)]

    end = solve_ivp(slopes, (0.0, 1.0), [0.0, 0.0, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14)
    rotation, _, along, across = end.y[:, -1]
    c, s = np.cos(rotation), np.sin(rotation)
    # theta = rotation - psi
    return Bent(float(c * along + s * across), float(s * along - c * across), float(rotation))


# Beck's column (Beck 1952): EI = m = L = 1, small deflections w exp(s t) with w'''' + p w'' + s^2 w = 0,
# w = w' = 0 at the foot, and no moment and no shear at the tip, for the force p turns with it.


def _tip(p: float, s: complex) -> tuple[complex, complex]:
    """Determinant of the conditions at the tip, and tip deflection under a unit side force times that."""
    root = np.sqrt(0.25 * p * p - s * s + 0j)
    a, b = np.sqrt(root - 0.5 * p), np.sqrt(root + 0.5 * p)
    # w = A (cosh ax - cos bx) + B (sinh(ax)/a - sin(bx)/b)
    bend = a * a * np.cosh(a) + b * b * np.cos(b)
    by_b, by_a = a * np.sinh(a) + b * np.sin(b), a**3 * np.sinh(a) - b**3 * np.sin(b)
    cosine, sine = np.cosh(a) - np.cos(b), np.sinh(a) / a - np.sin(b) / b
    return complex(bend * bend - by_a * by_b), complex(by_b * cosine - bend * sine)


def flutter() -> tuple[float, float]:
    """Load and frequency at which the first two frequencies meet: a double root."""

    def defect(y: FloatArray) -> list[float]:
        # even in s and real on its axis: the slope is that of an imaginary step
        p, omega = y
        return [_tip(p, 1j * omega)[0].real, (_tip(p, 1j * omega + 1e-30)[0]).imag / 1e-30]

    p, omega = fsolve(defect, [20.0, 11.0], xtol=1e-13)
    return float(p), float(omega)


def first_pair(p: float) -> complex:
    """Growing motion s above the load of flutter."""

    def defect(y: FloatArray) -> list[float]:
        value = _tip(p, complex(y[0], y[1]))[0]
        return [value.real, value.imag]

    rate, omega = fsolve(defect, [2.2 * np.sqrt(p - 20.05), 11.0], xtol=1e-13)
    return complex(rate, omega)


def motions(p: float, modes: int = 6) -> list[complex]:
    """Roots s in the upper half plane, in pairs with their conjugates."""
    grid = np.linspace(0.5, 400.0, 4000)

    def on_axis(omega: float) -> float:
        return _tip(p, 1j * omega)[0].real

    values = np.array([on_axis(omega) for omega in grid])
    steps = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    roots = [1j * float(brentq(on_axis, grid[k], grid[k + 1], xtol=1e-13)) for k in steps]
    if p > flutter()[0]:
        grows = first_pair(p)
        roots = [grows, -grows.conjugate(), *roots]
    return roots[:modes]


def after_gust(p: float, force: float, duration: float) -> Callable[[FloatArray], FloatArray]:
    """Tip deflection over the time since the middle of a gust: a side force at the tip rising to ``force``
    and falling to zero, each in half the duration, on a column at rest.
    """
    circle = 0.3 * np.exp(2j * np.pi * np.arange(32) / 32.0)
    terms = []
    for s in motions(p):
        around = [_tip(p, s + z) for z in circle]
        # residue of the tip's compliance, by the mean over a circle
        residue = np.mean([z * top / whole for z, (whole, top) in zip(circle, around, strict=True)])
        x = 0.25 * s * duration
        terms.append((s, 0.5 * force * duration * (np.sinh(x) / x) ** 2 * residue))
    return lambda t: np.sum([2.0 * (c * np.exp(s * t)).real for s, c in terms], axis=0)
