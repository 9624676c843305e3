"""One stage as a problem for Newton's method: balance M a + r = 0 of the free DOFs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import sqrt
from sys import maxsize
from typing import TYPE_CHECKING, TypeAlias

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.rod_frames import FrameState
from .assembly import Linearized
from .kept import Kept
from .linear.factors import Factors
from .linear.updated import UpdatedFactors
from .stage import Stage
from .system import System

if TYPE_CHECKING:
    from .marched import Rule
    from .woven import Solved


class ExhaustedError(Exception):
    """The linear solves allowed are used up."""


def _root(slope: Callable[[float], float], at_start: float, end: float) -> float:
    """A part of the way to ``end`` where a slope is small against that at the start; maybe ``end``."""
    near, small = at_start, _FLAT * abs(at_start)
    low, high, far = 0.0, end, slope(end)
    if far <= small or near >= 0.0:
        return end
    for _ in range(_LOOKS):
        part = high - far * (high - low) / (far - near)
        found = slope(part)
        if abs(found) <= small:
            return part
        if found < 0.0:
            low, near, far = part, found, 0.5 * far
        else:
            high, far, near = part, found, 0.5 * near
    return part


@frozen
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


# Of the way that is free the first guess goes a little less.
_SAFE = 0.9
# The residual along a step counts as balanced below this share of what it was, and is looked at so often.
_FLAT, _LOOKS = 0.3, 8
# Tangent over inertia up to which single precision will do: rounding is then a hundredth of the inertia at
# most, and a tangent that is indefinite by more is seen; iterations on rough factors gain four digits each.
_STIFF = 1e5

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


@frozen
class NewtonSettings:
    """Stopping rule.

    Attributes:
        tolerance: Residual relative to the largest force in the model [1].
        max_iterations: Factorisations before giving up, of full steps and line search together.
        patience: Factorisations before a stage that need not be solved now is given up.
        slow: Factorisations from which a solution is doubted, and asked for from another guess.
        factorize: Chooses the tangent, an entry of ``TANGENTS``.
    """

    tolerance: float = 1e-8
    max_iterations: int = 100
    patience: int = 100
    slow: int = maxsize
    factorize: Factorize = exact


def rule(system: System, settings: NewtonSettings, most: int, slow: int = maxsize) -> Rule:
    """The same for compiled steps, with ``most`` factorisations at most, and fewer than ``slow``."""
    from .marched import Rule

    return Rule(min(most, settings.max_iterations), slow, settings.tolerance, system.extent)


@dataclass(slots=True)
class StageProblem:
    """What Newton's method asks for; counts the factorisations it has had.

    Attributes:
        system: The model bound to its free DOFs.
        stage: What is solved.
        stored: Frames at the start of the step.
        settings: Stopping rule.
        kept: Factors that the step keeps.
        spent: Linear solves done, those of shifted tangents and factorisations of projected ones included.
        turned: Steps on which friction turned round: many where bodies come to stick, and no sign of a wrong
            root, so that as many more solves may be done.
    """

    system: System
    stage: Stage
    stored: FrameState
    settings: NewtonSettings
    kept: Kept = field(default_factory=Kept)
    spent: int = field(default=0, init=False)
    turned: int = field(default=0, init=False)

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
        most = self.settings.max_iterations
        return self.spent >= most + min(self.turned, most)

    def at_once(self, guess: FloatArray, most: int) -> Solved | None:
        """The stage solved by a compiled step; None where there is none, or it takes more than full steps.

        Args:
            guess: First guess, prescribed values in place, shape (n,).
            most: Factorisations at most.
        """
        woven = self.system.woven(
            lambda: self.system.configuration(self.stage, self.stage.predictor, self.stored)
        )
        if woven is None or self.spent:
            return None
        solved = woven.solve(self.stage, self.stored, guess, rule(self.system, self.settings, most))
        if solved is not None:
            self.spent = solved.iterations
        return solved

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
        if not self.system.changing:
            return 1.0
        return self.system.longest_step(self.stage, q, self._moved(q, step), self.stored)

    def stride(self, q: FloatArray, now: Linearized, step: FloatArray) -> float:
        """Part in (0, 1] of a step (m,) to take: the longest, or to where friction is in balance.

        Friction hardly grows with the slip but turns round with it, so that full steps may swing between
        both directions for ever. Where one turns round and the residual along the step does too, the root
        in between is looked for (Illinois).
        """
        if not self.system.changing:
            return 1.0
        long = self.longest_step(q, step)
        if not self.system.rubs:
            return long
        end = self._moved(q, long * step)
        if not self.system.reverses(self.stage, q, end, self.stored):
            return long
        self.turned += 1

        def slope(part: float) -> float:
            r = self.system.residual(self.stage, self._moved(q, part * step), self.stored)
            return float(r[self.free] @ step)

        return _root(slope, float(now.residual[self.free] @ step), long)

    def _moved(self, q: FloatArray, step: FloatArray) -> FloatArray:
        end = q.copy()
        end[self.free] += step
        return end

    def reachable(self, start: FloatArray, guess: FloatArray) -> FloatArray:
        """A guess cut back on the way from ``start`` so that nothing passes through anything.

        What is prescribed stays.
        """
        part = self.system.longest_step(self.stage, start, guess, self.stored)
        if part == 1.0:
            return guess
        cut = guess.copy()
        cut[self.free] = start[self.free] + _SAFE * part * (guess - start)[self.free]
        return cut

    def factorize(self, values: FloatArray) -> Factors:
        """Factors of stored entries, shape (slots,).

        Raises:
            ExhaustedError: No factorisation is left.
            FactorizationError: The matrix is singular or not finite.
        """
        if self.used_up:
            raise ExhaustedError
        self.spent += 1
        self.kept.drop()
        return self.system.solver.factorize(values)

    def step(self, q: FloatArray, now: Linearized, rhs: FloatArray) -> tuple[FloatArray, bool]:
        """Newton's step (m,), and whether the last factorised tangent is known to be indefinite.

        Args:
            q: Trial point, shape (n,).
            now: Residual and tangent there.
            rhs: What the tangent times the step is, shape (m,).

        Raises:
            ExhaustedError: No linear solve is left.
            FactorizationError: The matrix is singular or not finite.
        """
        if self.stage.weights.a > 0.0 and not self.used_up:
            step = self._iterated(now, rhs)
            if step is not None:
                self.spent += 1
                return step, False
        tangent = self.tangent(q, now)
        self.kept.keep(self.system.solver, tangent.factors)
        return tangent.updated(now).solve(rhs), tangent.factors.indefinite

    def _iterated(self, now: Linearized, rhs: FloatArray) -> FloatArray | None:
        """The step by iterations on kept factors, or on rough ones; None where neither are near enough."""
        solver, pattern = self.system.solver, self.system.pattern
        step = self.kept.solve(solver, pattern, now, rhs)
        if step is not None or self.system.changing or not self._lively(now):
            return step
        return self.kept.solve(solver, pattern, now, rhs) if self.kept.begin(solver, now.values) else None

    def _lively(self, now: Linearized) -> bool:
        """Whether no mass is held much more stiffly than its inertia holds it."""
        inertia = self.stage.weights.a * self.system.model.mass[self.free]
        return bool((now.values[self.diagonal] <= _STIFF * inertia)[inertia > 0.0].all())

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
