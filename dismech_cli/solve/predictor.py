"""First guesses of a stage.

Dynamics extrapolates the motion; where an integrator leaves out the acceleration, as much of the last one
is added as would have made the last guess best. Statics starts from the last equilibrium: where an end is
driven, moving that end alone may crush the edge beside it, so the rest follows by one linear solve with the
tangent at the last equilibrium, K_ff dq_f = -r_f - K_fh dq_h.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import Since, prescribe
from ..model.model import Model
from ..model.state import State
from ..model.term import Memory
from .linear.factors import FactorizationError
from .problem import ExhaustedError, StageProblem
from .stage import Stage
from .system import System

# Name in the memory of a state: which share of the lead would have made the last guess best.
_SHARE = "lead.share"


class Predictor:
    """Makes the first guesses of a model's stages."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def guesses(self, problem: StageProblem, since: Since, share: float = 0.0) -> Iterator[FloatArray]:
        """First guesses, prescribed values in place; the next is for where the last led nowhere.

        Args:
            problem: The stage.
            since: Where it begins.
            share: Of the lead of the stage, in [0, 1].
        """
        stage = problem.stage
        if stage.lead is not None and share > 0.0:
            led = stage.predictor + share * stage.lead
            prescribe(self._model.motions, led, stage.t_end, since)
            yield led
        plain = stage.predictor.copy()
        prescribe(self._model.motions, plain, stage.t_end, since)
        if stage.weights.a == 0.0:
            moved = plain - stage.predictor
            followed = self._followed(problem, moved) if moved.any() else None
            if followed is not None:
                yield followed
        yield plain

    def share(self, start: State) -> float:
        """Share in [0, 1] of the lead to go on by: what would have made the guess of the last step best."""
        return float(start.memory[_SHARE][0]) if _SHARE in start.memory else 0.0

    def learnt(self, stage: Stage, end: State) -> State:
        """The end of a stage that remembers which share of its lead would have made its guess best.

        In the norm of the mass it is near 1 in smooth motion, near 0 where something snaps. What touches does
        so at once, and the acceleration before tells little: models whose stencils come and go have no share.
        """
        if stage.lead is None or self._model.changing:
            return end
        weighted = self._model.mass * stage.lead
        size = float(weighted @ stage.lead)
        share = float(weighted @ (end.q - stage.predictor)) / size if size > 0.0 else 0.0
        return replace(end, memory=self.remembered(end.memory, min(max(share, 0.0), 1.0)))

    def remembered(self, memory: Memory, share: float) -> Memory:
        """A memory with the share that would have made the last guess best."""
        return {**memory, _SHARE: np.array([share])}

    def still(self, problem: StageProblem, since: Since) -> FloatArray:
        """Where the stage begins, with prescribed values in place."""
        guess = since.q.copy()
        prescribe(self._model.motions, guess, problem.stage.t_end, since)
        return guess

    def pull(self, problem: StageProblem, q: FloatArray, moved: FloatArray) -> FloatArray:
        """Change of the residual (n,) per motion ``moved`` (n,) of what is held: K_fh dq_h."""
        whole, pulled = self._whole, np.empty_like(moved)
        values = whole.linearize(problem.stage, q, problem.stored).values
        pulled[whole.pattern.free] = whole.pattern.product(values, moved[whole.pattern.free])
        return pulled

    @cached_property
    def _whole(self) -> System:
        """The model with nothing held: what is held pulls on the rest through its tangent."""
        return System(self._model, np.ones(self._model.dofs.n, dtype=np.bool_))

    def _followed(self, problem: StageProblem, moved: FloatArray) -> FloatArray | None:
        """The guess that follows what is held; None where the tangent or its step is no use."""
        start, free = problem.stage.predictor, problem.free
        with np.errstate(all="ignore"):
            pulled = self.pull(problem, start, moved)
            now = problem.linearize(start)
            try:
                step = problem.tangent(start, now).updated(now).solve(-now.residual[free] - pulled[free])
            except (FactorizationError, ExhaustedError):
                return None
            size, _ = problem.size(step)
        if not size <= problem.system.extent:
            return None
        guess = start + moved
        guess[free] += step
        return guess
