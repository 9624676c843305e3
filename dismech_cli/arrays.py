"""Array aliases and the shape letters used in every docstring of the project, and each value once.

======  =======================================================
``n``   degrees of freedom (DOFs) of the model
``m``   free DOFs: those that Newton solves for
``N``   nodes
``E``   rod edges
``T``   triangles
``S``   stencils of a term
``D``   DOFs per stencil
``R``   reduced variables per stencil (edge-vector components, angles)
``J``   joints: bend-twist stencils (node-edge-node-edge-node)
======  =======================================================
"""

from __future__ import annotations

from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]

Numbers: TypeAlias = FloatArray | float
"""One number for all places, or an array of one each."""

Number = TypeVar("Number", bound=np.generic)


def distinct(values: NDArray[Number]) -> NDArray[Number]:
    """Numbers, each once, ascending; np.unique of NumPy 2.4 hashes, far slower where few repeat.

    It also loads all there is for masked arrays, and so do those of NumPy that call it: 7 ms.
    """
    ordered = np.sort(values, axis=None)
    new = np.ones(len(ordered), dtype=np.bool_)
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    found: NDArray[Number] = ordered[new]
    return found


def union(a: NDArray[Number], b: NDArray[Number]) -> NDArray[Number]:
    """Numbers that are among one or the other, each once, ascending."""
    return distinct(np.concatenate((a, b), axis=None))


def shared(a: NDArray[Number], b: NDArray[Number]) -> NDArray[Number]:
    """Numbers that are among both, each once, ascending."""
    ordered = np.sort(np.concatenate((distinct(a), distinct(b))))
    found: NDArray[Number] = ordered[1:][ordered[1:] == ordered[:-1]]
    return found


def without(a: NDArray[Number], b: NDArray[Number]) -> NDArray[Number]:
    """Numbers that are among the first and not the second, each once, ascending."""
    found = distinct(a)
    return found[np.isin(found, b, invert=True)]


def median(values: FloatArray) -> float:
    """The number in the middle, of two the mean."""
    ordered, half = np.sort(values, axis=None), values.size // 2
    return float(ordered[half] if values.size % 2 else 0.5 * (ordered[half - 1] + ordered[half]))
