"""From a pure load kernel to what is bound: forces without potential, scaled over time by a signal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver, LoadLoop
from ..kernels.linearization import Linearization, Pattern
from ..kernels.shape import LoadKernel
from ..laws.signal import Signal
from .configuration import Configuration


@frozen
class BoundLoad:
    """A load bound to a pattern.

    Attributes:
        name: Unique name.
        loop: Adds the force at unit scale and its tangent.
        parameters: Constants in the order of the kernel, shape (P, S).
        signal: Scale over time [1].
    """

    name: str
    loop: LoadLoop
    parameters: FloatArray
    signal: Signal
    potential: ClassVar[None] = None

    @classmethod
    def of(
        cls,
        name: str,
        kernel: LoadKernel,
        dofs: IntArray,
        parameters: Mapping[str, FloatArray | float],
        signal: Signal,
        pattern: Pattern,
        driver: Driver,
        auxiliaries: IntArray | None = None,
    ) -> BoundLoad:
        """Make the gather-evaluate-scatter loop.

        Args:
            name: Unique name.
            kernel: The force.
            dofs: Global DOFs of each stencil, nodes first, angles last, shape (S, D).
            parameters: A value for each name of the kernel: numbers or arrays (S,).
            signal: Scale over time [1].
            pattern: Where the tangent's entries live.
            driver: Makes the loop.
            auxiliaries: Indices into the auxiliary array of the trial frames, shape (S, A); none
                where the kernel takes none.

        Raises:
            KeyError: A constant of the kernel is missing, or a name is none of its constants.
        """
        places = np.empty((len(dofs), 0), dtype=np.int64) if auxiliaries is None else auxiliaries
        values = kernel.parameters.stack(parameters, len(dofs))
        return cls(name, driver.load(kernel, dofs, places, pattern), values, signal)

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the force."""
        self.loop.add_residual(c.q, c.frames.auxiliary, self.parameters, self._scale(c), r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangent."""
        self.loop.add_linearization(c.q, c.frames.auxiliary, self.parameters, self._scale(c), into)

    def _scale(self, c: Configuration) -> float:
        return float(self.signal.value(c.t, c.inputs))
