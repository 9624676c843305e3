"""Which compiled loops a model would run: found by asking for them, without compiling any."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import Any

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from .driver import DragLoop, LoadLoop, LoopT, RateLoop, StencilLoop
from .linearization import Pattern
from .loop_text import LoopText, call_text, drag_text, load_text, map_text, rate_text, stencil_text
from .numpy_driver import NumpyDriver
from .shape import DragKernel, Kernel, LoadKernel, RateKernel


class _Idle:
    """A loop that is never run."""

    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"{name} of a loop that was only asked for")


@frozen
class WantedLoops:
    """A driver that notes what it is asked for; implements :class:`.driver.Driver`.

    Attributes:
        texts: What was asked for, by name.
        name: ``wanted``.
    """

    texts: dict[str, LoopText] = field(default_factory=dict)
    name: str = "wanted"

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Note the loops of an energy kernel."""
        loop: StencilLoop = self._noted(stencil_text(kernel))
        return loop

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Note the loops of a drag kernel."""
        loop: DragLoop = self._noted(drag_text(kernel))
        return loop

    def load(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> LoadLoop:
        """Note the loops of a load kernel."""
        loop: LoadLoop = self._noted(load_text(kernel))
        return loop

    def rate(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> RateLoop:
        """Note the loops of a rate kernel."""
        loop: RateLoop = self._noted(rate_text(kernel))
        return loop

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Note the loop of a map, and apply it to batches."""
        self._noted(map_text(function, len(inputs), outputs))
        return NumpyDriver().map(function, inputs, outputs)

    def compiled(self, loop: LoopT) -> LoopT | None:
        """Note a marked loop; it is run as it stands."""
        self._noted(call_text(loop))
        return loop

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """None: nothing is woven before there is a system."""
        return None

    def _noted(self, text: LoopText) -> Any:
        self.texts[text.name] = text
        return _Idle()
