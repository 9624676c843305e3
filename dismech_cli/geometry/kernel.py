"""One source, two speeds: the mark that lets NumPy and Numba run the same text.

A kernel is plain arithmetic on scalars-or-arrays: a vector is a tuple of components, and each
component may be a float (one stencil, inside a compiled loop), a float64 array (a batch of
stencils) or a complex number (complex-step derivative checks). Kernels therefore never branch on
data, never allocate and never index stencils.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

KernelT = TypeVar("KernelT", bound=Callable[..., Any])

_MARKED: list[Callable[..., Any]] = []


def kernel(function: KernelT) -> KernelT:
    """Mark ``function`` as kernel text; it stays an ordinary Python function.

    Numba is neither imported nor needed here: the compiled driver registers all marked functions
    when it is first asked for.
    """
    _MARKED.append(function)
    return function


def marked_kernels() -> tuple[Callable[..., Any], ...]:
    """Return every function marked so far, in order of definition."""
    return tuple(_MARKED)
