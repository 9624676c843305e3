"""One stage as a problem for Newton's method: balance M a + r = 0 of the free DOFs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import sqrt
from typing import TypeAlias

from ..arrays import FloatArray, IntArray
from ..kinematics.rod_frames import FrameState
from .assembly import Linearized
from .integrators import Stage
from .linear.factors import Factors
from .linear.updated import UpdatedFactors
from .system import System


class ExhaustedError(Exception):
    """The factorisations allowed are used up."""


@dataclass(frozen=True, slots=True)
class Tangent:
    """A factorised tangent.

    Attributes:
        values: The stored entries that were factorised, shape (slots,).
        factors: Their factors.
    """

    values: FloatArray
    factors: Factors

    def updated(self, now: Linearized) -> Factors:
        """Factors with the tangents outside the pattern."""
        return UpdatedFactors(self.factors, now.columns, now.rows) if now.columns.shape[1] else self.factors


Factorize: TypeAlias = "Callable[[StageProblem, FloatArray, Linearized], Tangent]"


def exact(problem: StageProblem, q: FloatArray, now: Linearized) -> Tangent:
    """Factorise the tangent as it is.

    Args:
        problem: The stage.
        q: Trial point, shape (n,).
        now: Residual and tangent there.

    Raises:
        FactorizationError: The matrix is singular or not finite.
    """
    return Tangent(now.values, problem.factorize(now.values))


@dataclass(frozen=True, slots=True)
class NewtonSettings:
    """Stopping rule.

    Attributes:
        tolerance: Residual relative to the largest force in the model [1].
        max_iterations: Factorisations before giving up, of full steps and line search together.
        patience: Factorisations before a stage that need not be solved now is given up.
        factorize: Chooses the tangent, an entry of ``TANGENTS``.
    """

    tolerance: float = 1e-8
    max_iterations: int = 100
    patience: int = 100
    factorize: Factorize = exact


@dataclass(slots=True)
class StageProblem:
    """What Newton's method asks for; counts the factorisations it has had.

    Attributes:
        system: The model bound to its free DOFs.
        stage: What is solved.
        stored: Frames at the start of the step.
        settings: Stopping rule.
        spent: Factorisations done, those of shifted and of projected tangents included.
    """

    system: System
    stage: Stage
    stored: FrameState
    settings: NewtonSettings
    spent: int = field(default=0, init=False)

    @property
    def free(self) -> IntArray:
        """Global index of each free DOF in matrix order, shape (m,)."""
        return self.system.pattern.free

    @property
    def diagonal(self) -> IntArray:
        """Slot of each diagonal entry of the tangent, shape (m,)."""
        return self.system.pattern.diagonal

    @property
    def used_up(self) -> bool:
        """Whether no factorisation is left."""
        return self.spent == self.settings.max_iterations

    def linearize(self, q: FloatArray) -> Linearized:
        """Residual and tangent at a trial point, with the stencils that are there."""
        return self.system.linearize(self.stage, q, self.stored)

    def linearize_projected(self, q: FloatArray) -> Linearized:
        """The same with tangents of energies made positive semi-definite, stencil by stencil."""
        return self.system.linearize_projected(self.stage, q, self.stored)

    def potential(self, q: FloatArray) -> tuple[float, FloatArray]:
        """Energy of all potential terms as part of the merit function [J], and the rest of the residual."""
        energy, rest = self.system.potential(self.stage, q, self.stored)
        return energy / self.stage.weights.q, rest

    def longest_step(self, q: FloatArray, step: FloatArray) -> float:
        """Part in (0, 1] of a step (m,) on which nothing passes through anything."""
        return self.system.longest_step(self.stage, q, step, self.stored)

    def factorize(self, values: FloatArray) -> Factors:
        """Factors of stored entries, shape (slots,).

        Raises:
            ExhaustedError: No factorisation is left.
            FactorizationError: The matrix is singular or not finite.
        """
        if self.used_up:
            raise ExhaustedError
        self.spent += 1
        return self.system.solver.factorize(values)

    def tangent(self, q: FloatArray, now: Linearized) -> Tangent:
        """The tangent to step with, as the settings choose it; raises as :meth:`factorize` does."""
        return self.settings.factorize(self, q, now)

    def size(self, x: FloatArray) -> tuple[float, float]:
        """Euclidean norms of the entries at positions and at angles of a vector in matrix order."""
        squares = x * x
        return sqrt(squares @ self.system.at_node), sqrt(squares @ self.system.at_angle)

    def small(self, size: tuple[float, float], now: Linearized, floor: float) -> bool:
        """Whether a free residual of this size is small against the model's forces, or within a floor [N]."""
        force, moment = size
        tolerance, length = self.settings.tolerance, self.system.model.length
        largest = max(now.moment, now.force * length)
        return force <= tolerance * now.force + floor and moment <= tolerance * largest + floor * length
