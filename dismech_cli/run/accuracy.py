"""How accurate a step is, in units of what is asked for."""

from __future__ import annotations

from dataclasses import field
from typing import Final, NamedTuple

from ..frozen import frozen
from ..solve.integrators import Integrator
from ..solve.step_result import StepResult
from .error_norm import ErrorNorm
from .growing import NONE

# Motion that grows counts as what it will be after this share of the run.
_SOON: Final = 0.04


class Measured(NamedTuple):
    """What is measured of a step.

    Attributes:
        motion: Largest motion so far [m].
        error: In units of the tolerance.
    """

    motion: float
    error: float


@frozen
class Accuracy:
    """Measures steps; remembers the last one, which is asked for when it is judged and when it is taken.

    Attributes:
        norm: Measures their error.
        integrator: Estimates it.
        rtol: Error of a step as a share of the motion that is asked for.
        t_end: End of the run [s].
    """

    norm: ErrorNorm
    integrator: Integrator
    rtol: float
    t_end: float
    _last: list[tuple[StepResult, float, float, Measured]] = field(
        default_factory=list, repr=False, compare=False
    )

    @property
    def order(self) -> int:
        """Power of the step that errors go with."""
        return self.integrator.error_order

    def of(self, result: StepResult, t: float, motion: float) -> Measured:
        """Measure a step from ``t`` [s], before which the largest motion was ``motion`` [m]."""
        for step, start, before, measured in self._last:
            if step is result and start == t and before == motion:
                return measured
        measured = self._measured(result, t, motion)
        self._last[:] = [(result, t, motion, measured)]
        return measured

    def _measured(self, result: StepResult, t: float, before: float) -> Measured:
        motion, h = max(before, self.norm.moved(result.state.q, t)), result.state.t - t
        error = self.integrator.error(result.trail, h)
        # What sets off will soon have moved farther: against its way so far the first steps would be as fine
        # as if nothing came of them. What swings no farther than before does not grow.
        soon = motion + (motion - before) / h * _SOON * self.t_end
        return Measured(motion, max(self.norm.share(error, soon, t) / self.rtol, NONE))
