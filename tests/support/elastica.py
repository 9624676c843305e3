"""The inextensible tip-loaded elastica by elliptic integrals (Bisshopp & Drucker 1945)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc


@dataclass(frozen=True)
class Elastica:
    """Tip of a clamped rod of unit length under a dead transverse tip force."""

    deflection: float
    shortening: float
    rotation: float


def tip_loaded_elastica(alpha: float) -> Elastica:
    """Tip for alpha = P L^2 / EI."""

    def modulus(rotation: float) -> tuple[float, float]:
        k = np.sqrt(0.5 * (1.0 + np.sin(rotation)))
        return k, np.arcsin(1.0 / (k * np.sqrt(2.0)))

    def defect(rotation: float) -> float:
        k, phi = modulus(rotation)
        return float(ellipk(k * k) - ellipkinc(phi, k * k) - np.sqrt(alpha))

    rotation = float(brentq(defect, 1e-9, 0.5 * np.pi - 1e-9, xtol=1e-14))
    k, phi = modulus(rotation)
    deflection = 1.0 - 2.0 / np.sqrt(alpha) * (ellipe(k * k) - ellipeinc(phi, k * k))
    return Elastica(float(deflection), float(1.0 - np.sqrt(2.0 * np.sin(rotation) / alpha)), rotation)
