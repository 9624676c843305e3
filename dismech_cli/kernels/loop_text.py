"""What a module of loops is, before it is compiled: its text and a name that stands for it."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Callable
from functools import cache
from typing import Any, Final

from ..frozen import frozen
from .availability import numba_version
from .fingerprint import fingerprint
from .numba_source import call_source, drag_source, load_source, map_source, rate_source, stencil_source
from .shape import DragKernel, Kernel, LoadKernel, RateKernel

FASTMATH: Final = ("nsz", "arcp", "contract", "afn", "reassoc")
"""Reassociation and contraction only: never nnan or ninf, which delete checks for NaN."""


@frozen
class LoopText:
    """The loops of one kernel in one shape.

    Attributes:
        name: Stands for all that is compiled: kernel, shape, options and versions.
        text: Of the module.
        main: The loop without which nothing goes: where it is compiled, so are most of the others.
    """

    name: str
    text: str
    main: str

    @classmethod
    def of(cls, function: Callable[..., Any], kind: str, text: str, main: str) -> LoopText:
        """Name the text of a kernel's loops."""
        digest = hashlib.sha256(text.encode())
        for part in (fingerprint(function), *FASTMATH, numba_version(), platform.python_version()):
            digest.update(part.encode())
        room = function.__module__.rpartition(".")[2]
        return cls(f"{room}_{function.__name__}_{kind}_{digest.hexdigest()[:16]}", text, main)


@cache
def stencil_text(kernel: Kernel) -> LoopText:
    """Loops of an energy kernel."""
    return LoopText.of(kernel.function, "stencils", stencil_source(kernel), "linearization")


@cache
def drag_text(kernel: DragKernel) -> LoopText:
    """Loops of a drag kernel."""
    return LoopText.of(kernel.function, "drag", drag_source(kernel), "linearization")


@cache
def load_text(kernel: LoadKernel) -> LoopText:
    """Loops of a load kernel."""
    return LoopText.of(kernel.function, "load", load_source(kernel), "linearization")


@cache
def rate_text(kernel: RateKernel) -> LoopText:
    """Loops of a rate kernel."""
    return LoopText.of(kernel.function, "rates", rate_source(kernel), "linearization")


@cache
def map_text(function: Callable[..., Any], inputs: int, outputs: int) -> LoopText:
    """The loop of a map kernel."""
    return LoopText.of(function, "map", map_source(function, inputs, outputs), "loop")


@cache
def call_text(function: Callable[..., Any]) -> LoopText:
    """A function that has loops of its own."""
    return LoopText.of(function, "call", call_source(function), "loop")
