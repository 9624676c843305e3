"""Dead loads: nodal forces of fixed direction, scaled by a signal.

Gravity, buoyancy, point and distributed loads are all of this kind: they add to the residual only
and cost nothing in the matrix.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..laws.signal import Signal
from ..model.configuration import Configuration


@frozen
class DeadLoad:
    """Force on the DOFs, constant in direction; implements both Term and BoundEnergy.

    Attributes:
        name: Unique name.
        force: Generalised force at unit scale [N], shape (n,).
        signal: Scale over time [1].
    """

    name: str
    force: FloatArray
    signal: Signal
    velocity_dependent: ClassVar[bool] = False

    @property
    def shares(self) -> tuple[str]:
        """One energy, that of the load."""
        return (self.name,)

    @property
    def steady(self) -> bool:
        """Whether the scale never changes."""
        return self.signal.constant

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """None."""
        return ()

    def bind(self, pattern: Pattern, driver: Driver) -> DeadLoad:
        """Return itself: nothing to look up."""
        return self

    @property
    def potential(self) -> DeadLoad:
        """Itself."""
        return self

    def energy(self, c: Configuration) -> FloatArray:
        """-f.q [J], shape (1, 1): the potential at fixed time."""
        return np.array([[-self._scale(c) * float(self.force @ c.q)]])

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the force."""
        r -= self._scale(c) * self.force

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force; there is no tangent."""
        self.add_residual(c, into.residual)

    def _scale(self, c: Configuration) -> float:
        return float(self.signal.value(c.t, c.inputs))
