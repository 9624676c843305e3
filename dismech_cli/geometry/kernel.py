"""One source, two speeds: the marks that let NumPy and Numba run the same text.

A kernel is plain arithmetic in terms of a few vector operations. In a compiled loop, and in
complex-step checks, a vector is a tuple of numbers; in a NumPy batch it is an array of shape
(3, n). Kernels therefore never branch on data, never allocate and never index stencils.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

KernelT = TypeVar("KernelT", bound=Callable[..., Any])

_MARKED: list[tuple[Callable[..., Any], Callable[..., Any]]] = []


def kernel(function: KernelT) -> KernelT:
    """Mark ``function`` as kernel text; it stays an ordinary Python function.

    Numba is neither imported nor needed here: the compiled driver registers all marked functions
    when it is first asked for.
    """
    _MARKED.append((function, function))
    return function


def loop(function: KernelT) -> KernelT:
    """Mark ``function`` as a loop over arrays of its own, which may branch and call kernels.

    It is what a driver that compiles runs in place of a batch that does the same.
    """
    return kernel(function)


def operation(batch: Callable[..., Any]) -> Callable[[KernelT], KernelT]:
    """Mark a vector operation whose last argument is a vector or block.

    The decorated text serves tuples; ``batch`` is its NumPy idiom for arrays with one row per
    component, which costs one call instead of one per component.
    """

    def mark(text: KernelT) -> KernelT:
        @wraps(text)
        def choose(*arguments: Any) -> Any:
            return (text if type(arguments[-1]) is tuple else batch)(*arguments)

        _MARKED.append((choose, text))
        return choose  # type: ignore[return-value]

    return mark


def selection(batch: Callable[..., Any]) -> Callable[[KernelT], KernelT]:
    """Mark an operation on numbers whose compiled text branches; outside compiled loops ``batch`` does it."""

    def mark(text: KernelT) -> KernelT:
        @wraps(text)
        def choose(*arguments: Any) -> Any:
            return batch(*arguments)

        _MARKED.append((choose, text))
        return choose  # type: ignore[return-value]

    return mark


def marked_kernels() -> tuple[tuple[Callable[..., Any], Callable[..., Any]], ...]:
    """Every marked function with the text that Numba compiles for it, in order of definition."""
    return tuple(_MARKED)
