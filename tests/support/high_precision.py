"""Differences of kernels in extended precision: for texts with atan2, which takes no complex step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray

_EPS = np.finfo(np.longdouble).eps
_NODES = ((-2, 1), (-1, -8), (1, 8), (2, -1))  # fourth-order central difference, over 12 h


def assert_kernel_derivatives(
    function: Callable[[Any, Any, Any], Any],
    y: FloatArray,
    a: FloatArray,
    p: FloatArray,
    *,
    size: float = 1.0,
) -> None:
    """Check gradient and Hessian of one stencil against differences of energy and gradient.

    Args:
        function: The kernel.
        y: Reduced variables.
        a: Auxiliary inputs.
        p: Parameters.
        size: Distance over which the kernel changes by order one: the smallest height or angle.
    """
    step = np.longdouble(_EPS**0.2 * size)
    y, a, p = (np.asarray(x, dtype=np.longdouble) for x in (y, a, p))
    _, gradient, hessian = function(tuple(y), tuple(a), tuple(p))
    slope, columns = [], []
    for k in range(len(y)):
        energy_slope, gradient_slope = np.longdouble(0.0), np.zeros(len(y), dtype=np.longdouble)
        for offset, weight in _NODES:
            z = y.copy()
            z[k] += offset * step
            e, g, _ = function(tuple(z), tuple(a), tuple(p))
            energy_slope += weight * e / (12 * step)
            gradient_slope += weight * np.array(g) / (12 * step)
        slope.append(energy_slope)
        columns.append(gradient_slope)
    full = np.zeros((len(y), len(y)), dtype=np.longdouble)
    full[np.triu_indices(len(y))] = hessian
    full += np.triu(full, 1).T
    # fourth order: (step/size)^4 = eps^(4/5), and as much round-off; the constant covers the 5th derivative
    tolerance = 1e4 * float(_EPS**0.8)
    assert np.abs(full).max() > 0.0
    largest = float(np.abs(full).max()) * size
    assert_allclose(
        np.array(gradient, dtype=np.float64),
        np.array(slope, dtype=np.float64),
        rtol=0,
        atol=tolerance * max(largest, float(np.abs(slope).max())),
    )
    assert_allclose(
        full.astype(np.float64),
        np.array(columns).T.astype(np.float64),
        rtol=0,
        atol=tolerance * float(np.abs(full).max()),
    )
