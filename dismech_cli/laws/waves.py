"""Wave shapes of one variable, shared by time laws and expressions."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray


def sawtooth(x: FloatArray | float, width: FloatArray | float = 1.0) -> Any:
    """A wave of period 2 pi that rises from -1 to 1 over the part ``width`` and falls over the rest.

    Args:
        x: Phase [rad], any shape.
        width: Rising part of the period, 0 to 1; 0.5 gives a triangle.

    Returns:
        Values in [-1, 1], shape of ``x``.
    """
    phase = np.mod(np.asarray(x, dtype=np.float64) / (2 * np.pi), 1.0)
    rise = np.clip(np.asarray(width, dtype=np.float64), 0.0, 1.0)
    up = 2.0 * phase / np.where(rise > 0.0, rise, 1.0) - 1.0
    down = 1.0 - 2.0 * (phase - rise) / np.where(rise < 1.0, 1.0 - rise, 1.0)
    return np.where(phase < rise, up, down)[()]


def square(x: FloatArray | float) -> Any:
    """A wave of period 2 pi: 1 over its first half, -1 over its second; ``x`` in radians."""
    return np.where(np.mod(x, 2 * np.pi) < np.pi, 1.0, -1.0)[()]


def step(x: FloatArray | float) -> Any:
    """0 below zero, 1 from zero on."""
    return np.where(np.asarray(x) >= 0.0, 1.0, 0.0)[()]


def smoothstep(x: FloatArray | float) -> Any:
    """0 below zero, 1 above one, and 3 x^2 - 2 x^3 between: its slope has no jump."""
    u = np.clip(x, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)
