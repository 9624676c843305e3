"""Smoothing along a body, in metres: (1 + (l/h)^2 L)^-2 with the graph Laplacian L."""

from __future__ import annotations

from typing import Any, Final, Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen


class Smoothing(Protocol):
    """A linear map of values at the places of a controller."""

    def __call__(self, values: FloatArray) -> FloatArray:
        """The values, smoothed; (n,) or (n, k)."""


@frozen
class Unsmoothed:
    """Leaves values as they are."""

    def __call__(self, values: FloatArray) -> FloatArray:
        """The values."""
        return values


UNSMOOTHED: Final = Unsmoothed()
"""No smoothing."""


@frozen
class GraphSmoothing:
    """Keeps constants and is symmetric, so nothing is lost; waves shorter than the length fade.

    Attributes:
        factors: Of 1 + (l/h)^2 L.
    """

    factors: Any

    @classmethod
    def of(cls, n: int, links: IntArray, spans: FloatArray, length: float) -> GraphSmoothing:
        """Make it.

        Args:
            n: Number of places.
            links: Neighbours, shape (L, 2).
            spans: Their distances h [m], shape (L,).
            length: Smoothing length l [m].
        """
        from scipy.sparse import coo_array, eye_array
        from scipy.sparse.linalg import splu

        i, j = links.T
        weight = (length / spans) ** 2
        rows, columns = np.concatenate((i, j, i, j)), np.concatenate((i, j, j, i))
        laplacian = coo_array((np.concatenate((weight, weight, -weight, -weight)), (rows, columns)), (n, n))
        return cls(splu((eye_array(n) + laplacian).tocsc()))

    def __call__(self, values: FloatArray) -> FloatArray:
        """The values, smoothed twice."""
        smooth: FloatArray = self.factors.solve(self.factors.solve(np.ascontiguousarray(values)))
        return smooth


def smoothing(n: int, links: IntArray, spans: FloatArray, length: float) -> Smoothing:
    """Smoothing by a length [m]; arguments as those of :meth:`GraphSmoothing.of`."""
    return GraphSmoothing.of(n, links, spans, length) if length > 0.0 and len(links) else UNSMOOTHED
