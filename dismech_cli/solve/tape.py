"""What a run leaves for its derivatives: every stage that was solved, step by step."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from ..frozen import frozen
from ..model.state import State
from .problem import NewtonSettings
from .relax import relaxed
from .status import Status
from .step import Advance, Stepper, through_stages
from .step_result import StepResult

THROUGH_STAGES: Final[tuple[Advance, ...]] = (through_stages, relaxed)
"""Ways of steps whose stages alone say how they went; a path of equilibria is not among them."""


@frozen
class TapedStep:
    """An accepted step.

    Attributes:
        dt: Its length [s].
        result: What it gave.
    """

    dt: float
    result: StepResult

    @property
    def start(self) -> State:
        """State that it began with, made ready."""
        return self.result.trail[0]


@dataclass(slots=True)
class Tape:
    """Steps that go in some way, as an :class:`~.step.Advance` that remembers them.

    Attributes:
        steps: The accepted ones, in order.
    """

    _advance: Advance
    steps: list[TapedStep] = field(default_factory=list)

    def __call__(self, stepper: Stepper, start: State, dt: float, settings: NewtonSettings) -> StepResult:
        """The step of length ``dt``; it takes the place of one from the same start that was given up."""
        while self.steps and self.steps[-1].start.t >= start.t:
            self.steps.pop()
        result = self._advance(stepper, start, dt, settings)
        if result.status is Status.CONVERGED:
            self.steps.append(TapedStep(dt, result))
        return result
