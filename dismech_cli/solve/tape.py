"""What a run leaves for its derivatives: every stage that was solved, step by step."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..arrays import FloatArray
from ..kinematics.rod_frames import FrameState
from ..model.state import State
from .integrators import Stage
from .newton import solve_stage
from .problem import NewtonSettings, StageProblem
from .relax import relax_stage, relaxed
from .result import NewtonResult
from .status import Status
from .step import Advance, Solve, Stepper, StepResult, through_stages

_SOLVES: dict[Advance, Solve] = {through_stages: solve_stage, relaxed: relax_stage}
"""How the steps that go through stages solve them; a path of equilibria is not among them."""


@dataclass(frozen=True, slots=True)
class SolvedStage:
    """A stage with its solution.

    Attributes:
        stage: What was solved.
        q: Its solution, shape (n,).
        stored: Frames that trial points were transported from.
        before: Shape that these are the frames of, shape (n,).
        since: Time of that shape [s].
    """

    stage: Stage
    q: FloatArray
    stored: FrameState
    before: FloatArray
    since: float


@dataclass(frozen=True, slots=True)
class TapedStep:
    """An accepted step.

    Attributes:
        start: State that it began with, made ready.
        dt: Its length [s].
        stages: What was solved.
        result: What it gave.
    """

    start: State
    dt: float
    stages: tuple[SolvedStage, ...]
    result: StepResult


@dataclass(slots=True)
class Tape:
    """Steps as an :class:`~.step.Advance` that remembers them.

    Attributes:
        steps: The accepted ones, in order.
    """

    _solve: Solve
    steps: list[TapedStep] = field(default_factory=list)
    _stages: list[SolvedStage] = field(default_factory=list)
    _start: State | None = None

    @classmethod
    def of(cls, advance: Advance) -> Tape | None:
        """A tape of steps that go in some way; None for a way that is not through stages."""
        solve = _SOLVES.get(advance)
        return None if solve is None else cls(solve)

    def __call__(self, stepper: Stepper, start: State, dt: float, settings: NewtonSettings) -> StepResult:
        """The step of length ``dt``; it takes the place of one from the same start that was given up."""
        while self.steps and self.steps[-1].start.t >= start.t:
            self.steps.pop()
        self._stages, self._start = [], start
        result = through_stages(stepper, start, dt, settings, self._remember)
        if result.status is Status.CONVERGED:
            self.steps.append(TapedStep(start, dt, tuple(self._stages), result))
        return result

    def _remember(self, problem: StageProblem, guess: FloatArray) -> NewtonResult:
        result = self._solve(problem, guess)
        if result.status is Status.CONVERGED:
            assert self._start is not None
            last = self._stages[-1] if self._stages else None
            before = self._start.q if last is None else last.q
            since = self._start.t if last is None else last.stage.t_end
            self._stages.append(SolvedStage(problem.stage, result.q, problem.stored, before, since))
        return result
