"""The time grid of a run, with steps halved after a failure and regrown after success.

Nominal times are multiples of dt (and the times at which a motion is released), so output never
changes the steps and rounding never accumulates. Inside a nominal step, halving gives dyadic
fractions; two successes at one level bring back the level above.
"""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np

from ..arrays import FloatArray, union
from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..solve.step_result import StepResult


def time_grid(dt: float, t_end: float, events: tuple[float, ...] = ()) -> FloatArray:
    """Nominal times [s] from 0 to ``t_end``, shape (steps + 1,)."""
    steps = max(int(np.ceil(t_end / dt * (1.0 - 1e-12))), 1)
    times: FloatArray = np.arange(steps + 1, dtype=np.float64) * dt
    times[-1] = t_end
    inside = np.array(sorted({t for t in events if 0.0 < t < t_end}))
    if inside.size:
        # an event next to a multiple of dt takes its place
        nearest = inside[np.clip(np.searchsorted(inside, times), 0, len(inside) - 1)]
        before = inside[np.clip(np.searchsorted(inside, times) - 1, 0, len(inside) - 1)]
        gap = np.minimum(np.abs(nearest - times), np.abs(before - times))
        gap[[0, -1]] = np.inf
        times = union(times[gap > 1e-9 * dt], inside)
    return times


@frozen
class Clock:
    """Where a run stands on its grid; implements :class:`~.step_control.StepControl`.

    Attributes:
        grid: Nominal times [s], shape (steps + 1,).
        max_cuts: How often a nominal step may be halved.
        index: Nominal step in progress: from ``grid[index]`` to ``grid[index + 1]``.
        part: Numerator of the fraction of it that is done.
        level: The fraction's denominator is 2**level.
    """

    grid: FloatArray
    max_cuts: int
    index: int = 0
    part: int = 0
    level: int = 0
    doubt: ClassVar[str] = ""
    calmer: ClassVar[str] = "reduce numerics.dt"
    finer: ClassVar[str] = "raise numerics.step.max_cuts"

    @property
    def t_end(self) -> float:
        """End of the grid [s]."""
        return float(self.grid[-1])

    @property
    def steps(self) -> int:
        """Number of nominal steps."""
        return len(self.grid) - 1

    @property
    def target(self) -> float:
        """Time [s] at the end of the next step."""
        start, end = float(self.grid[self.index]), float(self.grid[self.index + 1])
        part = self.part + 1
        return end if part == 2**self.level else start + (end - start) * (part / 2**self.level)

    @property
    def done(self) -> bool:
        """Whether the end of the grid is reached."""
        return self.index >= self.steps

    @property
    def exhausted(self) -> bool:
        """Whether the step is cut as often as it may be."""
        return self.level >= self.max_cuts

    def shorter(self, dt: float) -> str:
        """The change to a quarter of a step."""
        return f"numerics.dt={0.25 * dt:.3g} s"

    def refused(self, result: StepResult) -> None:
        """None: a step that Newton's method solved may stand."""

    def ahead(self, most: int) -> list[float]:
        """Nominal times up to the start of the last step, where no step is being cut."""
        if self.level or self.part:
            return []
        ahead: list[float] = self.grid[self.index + 1 : min(self.index + 1 + most, self.steps)].tolist()
        return ahead

    def passed(self, count: int) -> Clock:
        """The clock as many nominal steps on."""
        return replace(self, index=self.index + count)

    def accepted(self, result: StepResult) -> Clock:
        """The clock one step on; how the step went does not matter."""
        part, level = self.part + 1, self.level
        while level > 0 and part % 2 == 0:
            part, level = part // 2, level - 1
        if part >= 2**level and level == 0:
            # the next nominal step starts one level coarser than this one ended
            return Clock(self.grid, self.max_cuts, self.index + 1, 0, max(self.level - 1, 0))
        return replace(self, part=part, level=level)

    def failed(self) -> Clock:
        """The clock with the next step halved."""
        return replace(self, part=2 * self.part, level=self.level + 1)

    @property
    def closing(self) -> bool:
        """Whether the last nominal step begins: with a later end of the run it may be another one."""
        return self.index == self.steps - 1 and self.part == 0

    def joining(self, before: Clock, t: float) -> Clock:
        """This clock, of a changed scenario, where another stands at time ``t`` [s].

        On the steps that both share the place is kept; else this grid begins at ``t``.
        """
        known = before.index + (2 if before.part else 1)
        if np.array_equal(self.grid[:known], before.grid[:known]):
            return replace(self, index=before.index, part=before.part, level=before.level)
        return self.starting(t)

    def starting(self, t: float) -> Clock:
        """This clock with a grid that begins at ``t`` [s]."""
        later = self.grid[self.grid > t]
        # a time next to t is t, rounded
        near = later.size > 1 and later[0] - t < 1e-9 * (later[1] - later[0])
        return Clock(np.append(t, later[1:] if near else later), self.max_cuts)

    def arrays(self) -> Arrays:
        """The grid."""
        return {"grid": self.grid}

    def numbers(self) -> Numbers:
        """The place on the grid."""
        return {"index": self.index, "part": self.part, "level": self.level, "done": int(self.done)}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Clock:
        """The clock at the place that was saved."""
        index, part, level = (int(numbers[name]) for name in ("index", "part", "level"))
        return replace(self, grid=arrays["grid"], index=index, part=part, level=level)
