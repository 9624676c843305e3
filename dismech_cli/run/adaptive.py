"""Steps as long as a tolerance of their error allows."""

from __future__ import annotations

from dataclasses import field, replace
from typing import ClassVar

from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..solve.step_result import StepResult
from .accuracy import Accuracy
from .barred import Barred
from .growing import MOST, STANDS, grown, shrunk
from .stops import Stops
from .tolerance import Tolerance

# A run takes about so many steps at this tolerance, and these after every event.
_STEPS, _AT, _RESTART = 250.0, 1e-3, 6


@frozen
class Adaptive:
    """Where a run with adaptive steps stands; implements :class:`~.step_control.StepControl`.

    Attributes:
        tolerance: Of its steps.
        stops: Where they end too.
        accuracy: Measures them.
        at: Time [s].
        step: That the next step may have [s].
        last: Error of the last step, in units of the tolerance.
        cut: Whether the step has been shortened: then the next one does not grow.
        motion: Largest motion so far [m].
        forced: Steps that were less accurate than asked for, and could not be cut.
        barred: Lengths that failed lately.
    """

    tolerance: Tolerance
    stops: Stops
    accuracy: Accuracy
    at: float = 0.0
    step: float = 0.0
    last: float = 1.0
    cut: bool = False
    motion: float = 0.0
    forced: int = 0
    barred: Barred = field(default_factory=Barred)
    calmer: ClassVar[str] = "reduce numerics.step.rtol"
    finer: ClassVar[str] = "make numerics.step.dt_min shorter"

    @property
    def t_end(self) -> float:
        """End of the run [s]."""
        return self.stops.last

    @property
    def steps(self) -> int:
        """How many steps such runs usually take."""
        usual = _STEPS * float((_AT / self.tolerance.rtol) ** (1.0 / self.accuracy.order))
        pace = self.stops.pace
        least = self.t_end / min(self.tolerance.longest, pace.longest)
        return round(max(usual, least, len(self.stops.samples))) + _RESTART * len(pace.events)

    @property
    def target(self) -> float:
        """Time [s] at the end of the next step."""
        return self.stops.target(self.at, self.step)

    @property
    def done(self) -> bool:
        """Whether the end of the run is reached."""
        return self.at >= self.t_end

    @property
    def doubt(self) -> str:
        """That steps were less accurate than they should be."""
        return _inaccurate(self.forced, self.tolerance.shortest) if self.forced else ""

    @property
    def exhausted(self) -> bool:
        """Whether the next step may not be cut."""
        return min(self.step, self.target - self.at) <= self.tolerance.shortest

    @property
    def closing(self) -> bool:
        """Whether the next step ends at the end of the run."""
        return self.target >= self.t_end

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
        _, error = self.accuracy.of(result, self.at, self.motion)
        if error <= STANDS or self.exhausted:
            return None
        return self._cut(shrunk(error, self.accuracy.order))

    def failed(self) -> Adaptive:
        """The control with the next step halved."""
        return replace(self._cut(0.5), barred=self.barred.failed(self.target - self.at))

    def ahead(self, most: int) -> tuple[float, ...]:
        """None: each step goes as far as the last one allows."""
        return ()

    def passed(self, count: int) -> Adaptive:
        """Itself: no steps are ahead."""
        return self

    def accepted(self, result: StepResult) -> Adaptive:
        """The control a step on."""
        motion, error = self.accuracy.of(result, self.at, self.motion)
        t, most = result.state.t, 1.0 if self.cut else MOST
        factor = grown(error, self.last, self.accuracy.order, most)
        step = factor * (t - self.at)
        if factor >= 1.0:
            # an event or a law that shortened a step says nothing of the next one
            step = max(step, self.step)
        last = error
        if t >= self.stops.pace.next_event(self.at):
            step, last = min(step, self.tolerance.first), 1.0
        barred = self.barred.taken()
        return replace(
            self,
            at=t,
            step=min(max(barred.allowed(step), self.tolerance.shortest), self.tolerance.longest),
            barred=barred,
            last=last,
            cut=False,
            motion=motion,
            forced=self.forced + (error > STANDS),
        )

    def _cut(self, factor: float) -> Adaptive:
        step = max(factor * (self.target - self.at), self.tolerance.shortest)
        return replace(self, step=step, cut=True)

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
            **self.barred.numbers(),
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
            barred=self.barred.restore(numbers),
        )


def _inaccurate(forced: int, shortest: float) -> str:
    return (
        f"{forced} steps as short as numerics.step.dt_min = {shortest:.3g} s were less accurate than "
        "numerics.step.rtol asks for: make dt_min shorter, or see what moves so fast"
    )
