"""Plain steps: those that one compiled function takes from start to end, or many one after another.

They are plain where all stages converge by full steps, soon enough that nobody doubts their solutions. What
is held follows paths of time alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.motion import Since, prescribe
from ..kinematics.rod_frames import FrameState
from ..model.state import State
from .integrators import Integrator
from .newton import FULL_STEPS
from .predictor import Predictor
from .problem import NewtonSettings, rule
from .stage_maps import StageMaps
from .status import Status
from .step_result import StepResult
from .system import System

if TYPE_CHECKING:
    from .marched import March

# Grids whose times are rounded have a few lengths of steps.
_LENGTHS = 64


@frozen
class Steps:
    """Plain steps that were taken.

    Attributes:
        start: Where the first began.
        times: Where each began [s], and where the last one ended.
        maps: Of the stages of each.
        march: Where they went.
        predictor: Remembers what guesses should have been.
    """

    start: State
    times: Sequence[float]
    maps: tuple[StageMaps, ...]
    march: March
    predictor: Predictor

    @property
    def count(self) -> int:
        """How many."""
        return self.march.steps

    @property
    def iterations(self) -> int:
        """Linear solves of all."""
        return int(self.march.iterations[: self.count * self._stages].sum())

    @property
    def _stages(self) -> int:
        return len(self.maps[0].ends)

    def result(self, step: int) -> StepResult:
        """What one of them gave."""
        march, maps, at = self.march, self.maps[step], step * self._stages
        before = self.start if step == 0 else self._state(step - 1, at, self.times[step])
        ends = [*(self.times[step] + end for end in maps.ends[:-1]), self.times[step + 1]]
        trail = (before, *(self._state(step, at + 1 + k, end) for k, end in enumerate(ends)))
        return StepResult(
            trail[-1],
            Status.CONVERGED,
            sum(march.iterations[at : at + len(ends)].tolist()),
            float(march.norms[step]),
            march.residuals[step],
            -1,
            trail=trail,
            reactions=march.reactions[step] if maps.balanced_end else None,
            auxiliary=march.auxiliaries[step],
        )

    def kept(self, step: int) -> State:
        """The end of one of them, for who keeps it for long: it holds no memory but its own."""
        end = self.result(step).state
        frames = FrameState(*(np.array(getattr(end.frames, one.name)) for one in fields(FrameState)))
        return replace(end, q=end.q.copy(), v=end.v.copy(), a=end.a.copy(), frames=frames)

    def at_ends(self, dofs: IntArray) -> tuple[FloatArray, FloatArray]:
        """Values and rates of some DOFs at the start and at the end of each step, shape (count + 1, K)."""
        rows = slice(0, self.count * self._stages + 1, self._stages)
        return self.march.rows.q[rows].take(dofs, axis=1), self.march.rows.v[rows].take(dofs, axis=1)

    @property
    def reactions(self) -> FloatArray:
        """What terms do to held DOFs at the end of each, if that is in balance, shape (count, K)."""
        return self.march.reactions[: self.count]

    @property
    def attempts(self) -> list[tuple[float, float, int, float]]:
        """Start and end [s], linear solves, and largest free residual [N] of each."""
        solves = self.march.iterations[: self.count * self._stages].reshape(self.count, -1).sum(axis=1)
        norms = self.march.norms.tolist()
        return [*zip(self.times[:-1], self.times[1:], solves.tolist(), norms, strict=False)]

    def _state(self, step: int, row: int, t: float) -> State:
        rows, start, memory = self.march.rows, self.start, self.start.memory
        if self.maps[step].leads:
            memory = self.predictor.remembered(memory, float(self.march.shares[step]))
        return State(
            t, rows.q[row], rows.v[row], rows.a[row], rows.frames(row, start.frames), start.inputs, memory
        )


class Plain:
    """Takes the plain steps of a system."""

    def __init__(
        self,
        system: System,
        integrator: Integrator,
        predictor: Predictor,
        held: BoolArray,
        led: IntArray,
        t: float,
    ) -> None:
        """Take none yet.

        Args:
            system: The model, bound to its free DOFs.
            integrator: Time integrator.
            predictor: Makes first guesses.
            held: Mask of the DOFs that follow a motion, shape (n,).
            led: Those and the massless ones.
            t: A time at which they do [s].
        """
        self._system, self._integrator, self._predictor = system, integrator, predictor
        self._held, self._led = np.flatnonzero(held), led
        self._motions = [motion for motion in system.model.motions if t < motion.release]
        self._until = min((motion.release for motion in self._motions), default=np.inf)
        timed = not any(motion.remembers for motion in self._motions)
        self._fits = timed and bool(system.model.mass.any()) and not system.model.changing
        self._t = t
        self._maps: dict[float, StageMaps] = {}

    @cached_property
    def balanced_ends(self) -> bool:
        """Whether steps end where their last stages are in balance."""
        return self._maps_of(1.0).balanced_end

    def take(
        self, start: State, times: Sequence[float], lengths: Sequence[float], settings: NewtonSettings
    ) -> Steps | None:
        """Take steps one after another, as far as they are plain; None if the first is not.

        Args:
            start: Where the first begins, prepared for it.
            times: Where each begins [s], and where the last one ends.
            lengths: How long they are [s]: the differences, but for rounding.
            settings: Newton's stopping rule.
        """
        if not self._fits or start.load is not None or times[-1] > self._until:
            return None
        system = self._system
        woven = system.woven(lambda: system.at(start))
        if woven is None:
            return None
        from .marched import Held

        maps = tuple([self._maps_of(dt) for dt in lengths])
        ends = [t + end for t, of_step in zip(times, maps, strict=False) for end in of_step.ends]
        march = woven.march(
            start,
            times[:-1],
            maps,
            self._predictor.share(start) if maps[0].leads else 0.0,
            Held(self._held, self._values(start, ends), self._led),
            rule(system, settings, FULL_STEPS, settings.slow),
        )
        count = march.steps
        return Steps(start, times[: count + 1], maps[:count], march, self._predictor) if count else None

    def _maps_of(self, dt: float) -> StageMaps:
        """Maps of the stages of a step of some length [s]; those asked for of late are kept."""
        if dt not in self._maps:
            if len(self._maps) >= _LENGTHS:
                self._maps.clear()
            self._maps[dt] = StageMaps.of(self._integrator, dt)
        return self._maps[dt]

    def _values(self, start: State, ends: Sequence[float]) -> FloatArray:
        """Values of what is held at times [s], shape (times, K); of what stays, once for all."""
        if self._staying is not None:
            return self._staying
        values = np.empty((len(ends), len(self._held)))
        q, since = start.q.copy(), Since(start.t, start.q, start.frames)
        for row, t in zip(values, ends, strict=True):
            prescribe(self._motions, q, t, since)
            q.take(self._held, out=row)
        return values

    @cached_property
    def _staying(self) -> FloatArray | None:
        """Values of what is held, shape (1, K), if none of it ever moves."""
        model = self._system.model
        q = model.rest.copy()
        prescribe(self._motions, q, self._t, Since(self._t, q, model.frames.rest(q)))
        still = np.zeros_like(q)
        stays = all(motion.stays(q, still).all() for motion in self._motions)
        return q.take(self._held)[None] if stays else None
