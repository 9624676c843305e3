"""What runs kernels: plain NumPy always, compiled Numba loops when wanted and present."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from ..arrays import FloatArray, IntArray
from .linearization import Linearization, Pattern
from .loop_text import LoopText
from .shape import DragKernel, Kernel, LoadKernel, RateKernel

LoopT = TypeVar("LoopT", bound=Callable[..., Any])


class StencilLoop(Protocol):
    """All stencils of one energy, gathered, evaluated and scattered."""

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Shares of the energy of each stencil [J], shape (shares, S)."""

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq to ``r``, shape (n,)."""

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and d2E/dq2."""


class DragLoop(Protocol):
    """All stencils of one velocity-dependent force."""

    def add_residual(self, q: FloatArray, v: FloatArray, parameters: FloatArray, r: FloatArray) -> None:
        """Add -f to ``r``, shape (n,)."""

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add -f, -df/dq and -df/dv."""


class LoadLoop(Protocol):
    """All stencils of one force without potential."""

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, scale: float, r: FloatArray
    ) -> None:
        """Add -f at some scale to ``r``, shape (n,)."""

    def add_linearization(
        self,
        q: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        scale: float,
        into: Linearization,
    ) -> None:
        """Add -f and -df/dq at some scale."""


class RateLoop(Protocol):
    """All stencils of one viscous stress."""

    def add_residual(
        self, q: FloatArray, v: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add the residual to ``r``, shape (n,)."""

    def add_linearization(
        self,
        q: FloatArray,
        v: FloatArray,
        auxiliary: FloatArray,
        parameters: FloatArray,
        into: Linearization,
    ) -> None:
        """Add the residual and both tangents."""


class Driver(Protocol):
    """Turns kernels into loops."""

    @property
    def name(self) -> str:
        """``numpy`` or ``numba``."""

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel over stencils (S, D) with auxiliary inputs (S, A)."""

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel over stencils (S, D)."""

    def load(self, kernel: LoadKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> LoadLoop:
        """Loop of a load kernel over stencils (S, D) with auxiliary inputs (S, A)."""

    def rate(self, kernel: RateKernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> RateLoop:
        """Loop of a rate kernel over stencils (S, D) with auxiliary inputs (S, A)."""

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Apply a kernel column by column: (inputs, k) to (outputs, k)."""

    def compiled(self, loop: LoopT) -> LoopT | None:
        """A marked loop compiled, from its first call on; None where batches serve in its place."""

    def woven(self, text: LoopText, parts: tuple[LoopText, ...]) -> Callable[..., Any] | None:
        """A loop that runs others, compiled; None where there are none to run.

        Args:
            text: Its module, which looks the others up by their names.
            parts: The modules of these.
        """
