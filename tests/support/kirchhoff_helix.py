"""Small vibrations of a helical rod, clamped at one end, from the equations of Kirchhoff and Love.

The transfer matrix of the harmonic equations (Wittrick 1966; Pearson 1982) in fixed axes, for a round
rod that stretches but does not shear: displacement u, rotation p, force F and moment M along the arc,

    u' = p x t + (t.F) t / EA,   p' = M/EI + (1/GJ - 1/EI) (t.M) t,
    F' = -w^2 m u,               M' = -t x F - w^2 j (t.p) t.

Six solutions start at the clamp; a frequency makes those that leave the far end free dependent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dismech_cli.arrays import FloatArray


@dataclass(frozen=True)
class RoundHelix:
    """A natural helix about -z that starts at (radius, 0, 0) turned by -90 degrees, unstressed.

    Attributes:
        radius: Of the cylinder [m].
        height: Along the axis [m].
        turns: Number of turns, right-handed about -z.
        wire: Radius of the wire [m].
        modulus: Young's modulus [Pa], of an incompressible material.
        density: [kg/m^3].
    """

    radius: float
    height: float
    turns: float
    wire: float
    modulus: float
    density: float

    @property
    def length(self) -> float:
        """Length of the wire [m]."""
        return float(np.hypot(2.0 * np.pi * self.turns * self.radius, self.height))

    def tangent(self, x: float) -> FloatArray:
        """Unit tangent at the fraction ``x`` of the length."""
        around = 2.0 * np.pi * self.turns
        phase = 0.5 * np.pi - around * x
        slope = self.radius * around
        return np.array([slope * np.sin(phase), -slope * np.cos(phase), -self.height]) / self.length

    def transfer(self, omega: float, places: FloatArray) -> FloatArray:
        """The six solutions that start with a force or a moment at the clamp, shape (places, 12, 6).

        Lengths are in units of the wire's length, moments in EI over it.
        """
        length, area = self.length, np.pi * self.wire**2
        inertia = 0.25 * np.pi * self.wire**4
        bending = self.modulus * inertia
        extension = bending / length**2 / (self.modulus * area)
        torsion = 1.5  # EI/GJ of an incompressible round wire
        mass = omega**2 * self.density * area * length**4 / bending
        spin = omega**2 * self.density * 2.0 * inertia * length**2 / bending

        def slopes(x: float, y: FloatArray) -> FloatArray:
            t = self.tangent(x)
            u, p, force, moment = y.reshape(4, 3, 6)
            along = np.outer(t, t)
            cross = np.array([[0.0, -t[2], t[1]], [t[2], 0.0, -t[0]], [-t[1], t[0], 0.0]])
            out = np.stack(
                (
                    -cross @ p + extension * along @ force,
                    moment + (torsion - 1.0) * along @ moment,
                    -mass * u,
                    -cross @ force - spin * along @ p,
                )
            )
            return out.reshape(-1)

        start = np.zeros((12, 6))
        start[6:] = np.eye(6)
        made = solve_ivp(
            slopes, (0.0, 1.0), start.reshape(-1), t_eval=places, rtol=1e-9, atol=1e-12, method="DOP853"
        )
        return made.y.T.reshape(-1, 12, 6)

    def mode(self, low: float, high: float, places: FloatArray) -> tuple[float, FloatArray]:
        """Angular frequency [rad/s] between two that bracket one alone, and its shape at ``places``.

        Args:
            low: Below the frequency [rad/s].
            high: Above it [rad/s].
            places: Fractions of the length, ending with 1.

        Returns:
            The frequency and displacements of unit largest size, shape (places, 3).
        """

        def determinant(omega: float) -> float:
            return float(np.linalg.det(self.transfer(omega, np.ones(1))[0, 6:]))

        omega = float(brentq(determinant, low, high, xtol=1e-6 * low))
        solutions = self.transfer(omega, places)
        weights = np.linalg.svd(solutions[-1, 6:])[2][-1]
        shape = solutions[:, :3] @ weights
        return omega, shape / np.linalg.norm(shape, axis=1).max()
