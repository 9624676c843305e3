"""First guesses of a stage.

Dynamics extrapolates the motion. Statics starts from the last equilibrium: where an end is driven, moving
that end alone may crush the edge beside it, so the rest follows by one linear solve with the tangent at
the last equilibrium, K_ff dq_f = -r_f - K_fh dq_h.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from ..arrays import FloatArray
from ..kinematics.motion import Since, prescribe
from ..model.model import Model
from .linear.factors import FactorizationError
from .problem import ExhaustedError, StageProblem
from .system import System


class Predictor:
    """Makes the first guesses of a model's stages."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def guesses(self, problem: StageProblem, since: Since) -> Iterator[FloatArray]:
        """First guesses, prescribed values in place; the next is for where the last led nowhere."""
        stage = problem.stage
        plain = stage.predictor.copy()
        prescribe(self._model.motions, plain, stage.t_end, since)
        if stage.weights.a == 0.0:
            moved = plain - stage.predictor
            followed = self._followed(problem, moved) if moved.any() else None
            if followed is not None:
                yield followed
        yield plain

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
