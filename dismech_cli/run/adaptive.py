"""Steps as long as a tolerance of their error allows.

PI control of the step (Gustafsson 1991; Hairer and Wanner 1996, IV.8), restarted where something jumps.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import floor, inf
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..model.saved import Arrays, Numbers
from ..solve.integrators import Integrator
from ..solve.step import StepResult
from .error_norm import ErrorNorm
from .pace import Pace

# Safety, and exponents of this and of the last error, over the order of the error.
_SAFE, _NOW, _LAST = 0.9, 0.7, 0.4
# By how much a step may differ from the last one, and an error that counts as none.
_LEAST, _MOST, _NONE = 0.2, 2.0, 1e-8
# Steps that the last error alone would change by less stay: a change costs generalised-alpha accuracy. What
# could be longer than that grows at least by a power of it: where errors stay small, PI control hardly grows.
_KEPT, _EAGER = (0.9, 1.5), 0.35
# A step that ends this share of itself before an event goes on to it.
_STRETCH = 1.1
# Motion that grows counts as what it will be after this share of the run.
_SOON = 0.01
# A run takes about so many steps at a tolerance of 1e-3, and these after every event.
_STEPS, _RESTART = 250.0, 6


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What a user asks of adaptive steps.

    Attributes:
        rtol: Error of a step as a share of the motion.
        first: Step at the start and after events [s].
        shortest: Step below which none is cut [s].
        longest: Step beyond which none grows [s].
    """

    rtol: float
    first: float
    shortest: float
    longest: float


@dataclass(frozen=True, slots=True)
class Adaptive:
    """Where a run with adaptive steps stands; implements :class:`~.step_control.StepControl`.

    Attributes:
        tolerance: Of its steps.
        pace: What they must not step over.
        norm: Measures their error.
        integrator: Estimates it.
        every: Time between marks at which steps end too [s]: frames of runs that have none in between;
            infinite without.
        samples: Times at which steps end too, ascending [s]: those at which controllers sample.
        at: Time [s].
        step: That the next step may have [s].
        last: Error of the last step, in units of the tolerance.
        cut: Whether the step has been shortened: then the next one does not grow.
        motion: Largest motion so far [m].
        forced: Steps that were less accurate than asked for, and could not be cut.
    """

    tolerance: Tolerance
    pace: Pace
    norm: ErrorNorm
    integrator: Integrator
    every: float = inf
    samples: FloatArray = field(default_factory=lambda: np.empty(0))
    at: float = 0.0
    step: float = 0.0
    last: float = 1.0
    cut: bool = False
    motion: float = 0.0
    forced: int = 0

    @property
    def t_end(self) -> float:
        """End of the run [s]."""
        return float(self.pace.events[-1])

    @property
    def steps(self) -> int:
        """How many steps such runs usually take."""
        usual = _STEPS * float((RTOL / self.tolerance.rtol) ** (1.0 / self.integrator.error_order))
        least = self.t_end / min(self.tolerance.longest, self.pace.longest)
        return round(max(usual, least, len(self.samples))) + _RESTART * len(self.pace.events)

    @property
    def target(self) -> float:
        """Time [s] at the end of the next step."""
        event = min(self.pace.next_event(self.at), self._next_mark, self._next_sample)
        step = min(self.step, self.pace.limit(self.at) - self.at)
        if event - self.at <= _STRETCH * step:
            return event
        # two equal steps rather than a long one and the rest
        return self.at + min(step, 0.5 * (event - self.at))

    @property
    def done(self) -> bool:
        """Whether the end of the run is reached."""
        return self.at >= self.t_end

    @property
    def doubt(self) -> str:
        """That steps were less accurate than they should be."""
        if not self.forced:
            return ""
        return (
            f"{self.forced} steps as short as numerics.step.dt_min = {self.tolerance.shortest:.3g} s were "
            "less accurate than numerics.step.rtol asks for: make dt_min shorter, or see what moves so fast"
        )

    @property
    def exhausted(self) -> bool:
        """Whether the next step may not be cut."""
        return min(self.step, self.target - self.at) <= self.tolerance.shortest

    @property
    def closing(self) -> bool:
        """Whether the next step ends at the end of the run."""
        return self.target >= self.t_end

    @property
    def calmer(self) -> str:
        """What makes steps shorter."""
        return "reduce numerics.step.rtol"

    @property
    def finer(self) -> str:
        """What lets steps be cut further."""
        return "make numerics.step.dt_min shorter"

    def shorter(self, dt: float) -> str:
        """The change to a tenth of the tolerance."""
        return f"numerics.step.rtol={0.1 * self.tolerance.rtol:.3g}"

    def starting(self, t: float) -> Adaptive:
        """This control at ``t`` [s], with its first step."""
        return replace(self, at=t)

    def joining(self, before: Adaptive, t: float) -> Adaptive:
        """This control, of a changed scenario, where another stands at time ``t`` [s]."""
        step = min(before.step, self.tolerance.longest)
        return replace(self, at=t, step=step, last=before.last, motion=before.motion, forced=before.forced)

    def refused(self, result: StepResult) -> Adaptive | None:
        """The control with a shorter step if the error of a step is too large; None if it may stand."""
        error = self._error(result, self._motion(result))
        if error <= 1.0 or self.exhausted:
            return None
        factor = max(_SAFE * error ** (-1.0 / self.integrator.error_order), _LEAST)
        return self._cut(factor)

    def failed(self) -> Adaptive:
        """The control with the next step halved."""
        return self._cut(0.5)

    def accepted(self, result: StepResult) -> Adaptive:
        """The control a step on."""
        motion = self._motion(result)
        error, t = self._error(result, motion), result.state.t
        factor = min(max(self._change(error), _LEAST), 1.0 if self.cut else _MOST)
        step = factor * (t - self.at)
        if factor >= 1.0:
            # an event or a law that shortened a step says nothing of the next one
            step = max(step, self.step)
        last = error
        if t >= self.pace.next_event(self.at):
            step, last = min(step, self.tolerance.first), 1.0
        return replace(
            self,
            at=t,
            step=min(max(step, self.tolerance.shortest), self.tolerance.longest),
            last=last,
            cut=False,
            motion=motion,
            forced=self.forced + (error > 1.0),
        )

    @property
    def _next_mark(self) -> float:
        """The first mark after now [s]."""
        if self.every == inf:
            return inf
        return self.every * (floor(self.at / self.every * (1.0 + 1e-12)) + 1)

    @property
    def _next_sample(self) -> float:
        """The first sample after now [s]."""
        place = int(np.searchsorted(self.samples, self.at, side="right"))
        return float(self.samples[place]) if place < len(self.samples) else inf

    def _change(self, error: float) -> float:
        """By how much the next step is longer than one of this error."""
        order = self.integrator.error_order
        alone = float(_SAFE * error ** (-1.0 / order))
        if _KEPT[0] <= alone <= _KEPT[1]:
            return 1.0
        smooth = float(_SAFE * error ** (-_NOW / order) * self.last ** (_LAST / order))
        return max(smooth, float(alone**_EAGER)) if alone > 1.0 else smooth

    def _cut(self, factor: float) -> Adaptive:
        step = max(factor * (self.target - self.at), self.tolerance.shortest)
        return replace(self, step=step, cut=True)

    def _motion(self, result: StepResult) -> float:
        return max(self.motion, self.norm.moved(result.state.q, self.at))

    def _error(self, result: StepResult, motion: float) -> float:
        """Error of a step in units of the tolerance."""
        h = result.state.t - self.at
        error = self.integrator.error(result.trail, h)
        # What sets off will soon have moved farther: against its way so far the first steps would be as fine
        # as if nothing came of them. What swings no farther than before does not grow.
        soon = motion + (motion - self.motion) / h * _SOON * self.t_end
        return max(self.norm.share(error, soon, self.at) / self.tolerance.rtol, _NONE)

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """Where it stands, and what the next step depends on."""
        return {
            "at": self.at,
            "step": self.step,
            "last": self.last,
            "cut": int(self.cut),
            "motion": self.motion,
            "forced": self.forced,
            "done": int(self.done),
        }

    def restore(self, arrays: Arrays, numbers: Numbers) -> Adaptive:
        """The control at the place that was saved."""
        return replace(
            self,
            at=float(numbers["at"]),
            step=float(numbers["step"]),
            last=float(numbers["last"]),
            cut=bool(numbers["cut"]),
            motion=float(numbers["motion"]),
            forced=int(numbers["forced"]),
        )


LENGTHS: Final = (1e-3, 1e-7, 0.1)
"""First, shortest and longest step by default, as shares of the run: measured on 24 scenes."""

RTOL: Final = 1e-3
"""Error of a step as a share of the motion, by default."""
