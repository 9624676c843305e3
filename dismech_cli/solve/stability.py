"""Signs of the eigenvalues of the stiffness matrix at a state: whether its balance is stable."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..model.state import State
from .linear.factors import FactorizationError
from .linear.stability import CountNegative, negative_eigenvalues_on
from .pattern import SparsityPattern
from .stage import at_state
from .system import System


class Stability:
    """Asks the stiffness matrix of one system; keeps what is analysed once for a pattern."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._count_negative: tuple[SparsityPattern, CountNegative] | None = None

    def unstable(self, state: State) -> bool:
        """Whether the stiffness matrix at a state is known to have a negative eigenvalue.

        Of what moves freely as a whole they are zero but for rounding and what is left of the residual:
        one that those explain is none.
        """
        system = self._system
        now = system.linearize(at_state(state), state.q, state.frames)
        values, diagonal = now.values.copy(), system.pattern.diagonal
        force = float(np.linalg.norm(now.residual[system.pattern.free] * system.at_node))
        least = (force + system.round_off(values, state.q)) / system.extent
        try:
            if not system.solver.factorize(values).indefinite:
                return False
            values[diagonal] += least * (system.at_node + system.at_angle * system.extent**2)
            return system.solver.factorize(values).indefinite
        except FactorizationError:  # a mechanism, which has its own messages
            return False

    def negative_eigenvalues(self, state: State, added: FloatArray | float = 0.0) -> int:
        """Negative eigenvalues of the stiffness matrix at a state.

        Args:
            state: Where.
            added: Added to its diagonal, shape (m,) or one number.

        Raises:
            FactorizationError: The matrix is singular or not finite.
        """
        values = self.stiffness(state)
        pattern = self._system.pattern
        values[pattern.diagonal] += added
        # few scenes ask, and MKL takes long to load
        if self._count_negative is None or self._count_negative[0] is not pattern:
            self._count_negative = pattern, negative_eigenvalues_on(pattern)
        return self._count_negative[1](values)

    def softest(self, state: State) -> int:
        """The free DOF whose own stiffness is not finite, or else nearest to none, at a state."""
        pattern = self._system.pattern
        stiffness = np.abs(self.stiffness(state)[pattern.diagonal])
        return int(pattern.free[np.argmin(np.where(np.isfinite(stiffness), stiffness, -1.0))])

    def stiffness(self, state: State) -> FloatArray:
        """Stored entries of the stiffness matrix, shape (slots,)."""
        return self._system.linearize(at_state(state), state.q, state.frames).values.copy()
