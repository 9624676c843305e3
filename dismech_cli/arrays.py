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

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .lazy_numpy import keep_lazy

keep_lazy()

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]

Numbers: TypeAlias = FloatArray | float
"""One number for all places, or an array of one each."""


def distinct(values: IntArray) -> IntArray:
    """Integers, each once, ascending; np.unique of NumPy 2.4 hashes, far slower where few repeat."""
    ordered = np.sort(values, axis=None)
    new = np.ones(len(ordered), dtype=np.bool_)
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    found: IntArray = ordered[new]
    return found
