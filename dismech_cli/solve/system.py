"""A model bound to a sparsity pattern: residual, tangent and potential of a stage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..kernels.driver import Driver
from ..kernels.linearization import Linearization, RankOne, all_symmetric
from ..kernels.projection import ProjectedDriver
from ..kinematics.rod_frames import FrameState
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundEnergy, BoundTerm
from .integrators import Stage, Weights
from .linear.choice import LINEAR_SOLVERS, choose_solver
from .linear.factors import LinearSolver
from .overlay import Overlay
from .pattern import SparsityPattern

_EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True)
class Linearized:
    """Residual and tangent at a trial point.

    The arrays belong to the system, which overwrites them at the next call: whoever keeps one copies it.

    Attributes:
        residual: M a + r, shape (n,); reactions on held DOFs.
        values: Stored entries of the tangent, shape (slots,).
        columns: Tangents outside the pattern are ``columns @ rows.T``: columns of the free DOFs in
            matrix order, shape (m, k); k is 0 but for forces that couple all with all.
        rows: See ``columns``.
        force: Euclidean norm of the largest force that any term, or sum of terms, exerts [N].
        moment: The same for angles [N m].
    """

    residual: FloatArray
    values: FloatArray
    columns: FloatArray
    rows: FloatArray
    force: float
    moment: float


@dataclass(frozen=True, slots=True)
class _Terms:
    """Terms bound to the pattern, those with symmetric tangents apart."""

    symmetric: tuple[BoundTerm, ...]
    general: tuple[BoundTerm, ...]


class System:
    """All terms bound to one pattern, with the buffers of assembly and a linear solver.

    Terms that stay are bound once, to the base pattern; those whose stencils come and go have an overlay
    on it. A scene without such terms has none, and one pattern for ever.

    Attributes:
        model: The semi-discrete system.
        pattern: Its free DOFs and the places of the tangent.
        solver: Factorises matrices of this pattern.
        analyses: How often a pattern has been analysed.
        at_node: 1 for free positions and 0 for angles, in matrix order, shape (m,).
        at_angle: The opposite.
        extent: Size of the rest shape [m].
    """

    def __init__(self, model: Model, free: BoolArray, solver: str = "auto") -> None:
        """Bind a model.

        Args:
            model: The semi-discrete system.
            free: Mask of the free DOFs, shape (n,).
            solver: Key of ``LINEAR_SOLVERS``, or ``"auto"``.
        """
        self.model = model
        couplings = [coupling for term in model.terms for coupling in term.couplings]
        symmetric = all_symmetric(couplings) and all(term.symmetric for term in model.changing)
        base = SparsityPattern.build(model.dofs, free, couplings, symmetric=symmetric)
        self._base = self.pattern = base
        self._exact = self._bound(model.driver)
        self._overlay = Overlay(base, model.changing, model.driver) if model.changing else None
        # sorted here: a check against a protocol costs as much as a term
        self._energies = [t for t in self.terms if isinstance(t, BoundEnergy)]
        self._others = [t for t in self.terms if not isinstance(t, BoundEnergy)]
        self._mirror = None if base.symmetric else base.mirror()
        self._damped = any(t.velocity_dependent for t in model.terms)
        self._buffers = Linearization.of(model.dofs.n, base.slots)
        self._free_mass = model.mass[base.free]
        self._has_mass = bool(model.mass.any())
        self._split = model.dofs.n_positions
        at_node = base.free < self._split
        self.at_node = at_node.astype(np.float64)
        self.at_angle = 1.0 - self.at_node
        self._inertia = np.zeros(base.slots)
        self._inertia_slope = 0.0
        self._nothing = np.empty((base.m, 0))
        self.extent = float(np.ptp(model.dofs.positions(model.rest), axis=0).max())
        spreads = any(term.spreads for term in model.changing)
        self._make_solver = LINEAR_SOLVERS[
            choose_solver(base, spreads=spreads) if solver == "auto" else solver
        ]
        self.analyses = 0
        self.solver: LinearSolver = self._analysed(base)

    @property
    def terms(self) -> tuple[BoundTerm, ...]:
        """Every bound term."""
        changing = () if self._overlay is None else self._overlay.terms
        return (*self._exact.symmetric, *self._exact.general, *changing)

    @cached_property
    def _projected(self) -> _Terms:
        """The terms with projected tangents; bound when first needed, which is seldom."""
        return self._bound(ProjectedDriver(self.model.driver))

    def _bound(self, driver: Driver) -> _Terms:
        # Symmetric tangents fill one triangle; it is mirrored before the others are added.
        symmetric = [t for t in self.model.terms if all(c.symmetric for c in t.couplings)]
        general = [t for t in self.model.terms if not all(c.symmetric for c in t.couplings)]
        return _Terms(
            tuple(t.bind(self._base, driver) for t in symmetric),
            tuple(t.bind(self._base, driver) for t in general),
        )

    def _analysed(self, pattern: SparsityPattern) -> LinearSolver:
        """Take a pattern for that of the matrix; make its solver."""
        self.pattern = pattern
        self._position_slots = pattern.diagonal[self.at_node == 1.0]
        self.analyses += 1
        return self._make_solver(pattern)

    def start_step(self) -> None:
        """Forget what came and went in the last step."""
        if self._overlay is not None:
            self._overlay.start_step()

    def configuration(self, stage: Stage, q: FloatArray, stored: FrameState) -> Configuration:
        """Evaluate the trial point of a stage."""
        position = stage.position(q)
        return Configuration(
            stage.t_stage,
            position,
            stage.velocity(q),
            self.model.frames.transport(stored, position),
        )

    def linearize(self, stage: Stage, q: FloatArray, stored: FrameState) -> Linearized:
        """Residual and tangent of a stage, with the sizes that say when the residual is small."""
        return self._assemble(self._exact, stage, q, stored)

    def linearize_projected(self, stage: Stage, q: FloatArray, stored: FrameState) -> Linearized:
        """The same with the tangents of energies made positive semi-definite stencil by stencil."""
        return self._assemble(self._projected, stage, q, stored)

    def _assemble(self, terms: _Terms, stage: Stage, q: FloatArray, stored: FrameState) -> Linearized:
        c = self.configuration(stage, q, stored)
        overlay = self._overlay
        if overlay is not None:
            overlay.detect(c)
            if overlay.follow():
                self.solver = self._analysed(overlay.pattern)
        into, w = self._buffers, stage.weights
        into.residual[:] = 0.0
        into.rank_ones.clear()
        into.stiffness[:] = self._tangent_of_inertia(w)
        if self._damped:
            into.damping[:] = 0.0
        forces, moments = into.residual[: self._split], into.residual[self._split :]
        # squares of norms: a partial sum is as large as the forces that will cancel in the whole
        force = moment = 0.0
        for term in terms.symmetric:
            term.add_linearization(c, into)
            force, moment = max(force, _square(forces)), max(moment, _square(moments))
        if self._mirror is not None:
            lower, upper = self._mirror
            into.stiffness[lower] = into.stiffness[upper]
            into.damping[lower] = into.damping[upper]
        for term in terms.general:
            term.add_linearization(c, into)
            force, moment = max(force, _square(forces)), max(moment, _square(moments))
        values = into.stiffness
        if w.q != 1.0:
            values *= w.q
        if self._damped:
            values += w.v * into.damping
        if overlay is not None:
            for _ in overlay.add(c, into.residual, into.rank_ones):
                force, moment = max(force, _square(forces)), max(moment, _square(moments))
            values = overlay.total(values, w.q, w.v)
        if self._has_mass:
            inertia = self.model.mass * stage.acceleration(q)
            head, tail = inertia[: self._split], inertia[self._split :]
            force, moment = max(force, _square(head)), max(moment, _square(tail))
            into.residual += inertia
        columns, rows = self._outside(into.rank_ones, w)
        return Linearized(into.residual, values, columns, rows, sqrt(force), sqrt(moment))

    def _outside(self, rank_ones: Sequence[RankOne], w: Weights) -> tuple[FloatArray, FloatArray]:
        """Columns and rows of the tangents outside the pattern, each of shape (m, k)."""
        if not rank_ones:
            return self._nothing, self._nothing
        columns = np.stack([one.column for one in rank_ones], axis=1)
        rows = np.stack([w.q * one.by_q + w.v * one.by_v for one in rank_ones], axis=1)
        return columns[self._base.free], rows[self._base.free]

    def _tangent_of_inertia(self, w: Weights) -> FloatArray:
        """Tangent values of the inertia before they are multiplied by the weight of positions."""
        if self._inertia_slope != w.a / w.q:
            self._inertia_slope = w.a / w.q
            self._inertia[self._base.diagonal] = self._inertia_slope * self._free_mass
        return self._inertia

    def potential(self, stage: Stage, q: FloatArray, stored: FrameState) -> tuple[float, FloatArray]:
        """Energy [J] of all potential terms at the stage, and the rest of the residual (n,).

        Divided by the stage's position weight the energy is the potential part of the stage's
        merit function; the rest (inertia, drag) is integrated along a search direction.
        """
        c = self.configuration(stage, q, stored)
        if self._overlay is not None:
            self._overlay.detect(c)
        rest = self.model.mass * stage.acceleration(q)
        for term in self._others:
            term.add_residual(c, rest)
        return sum(float(term.energy(c).sum()) for term in self._energies), rest

    def longest_step(self, stage: Stage, q: FloatArray, step: FloatArray, stored: FrameState) -> float:
        """Part in (0, 1] of a step of the free DOFs, shape (m,), on which nothing passes through anything."""
        if self._overlay is None:
            return 1.0
        end = q.copy()
        end[self.pattern.free] += step
        return self._overlay.longest_step(
            self.configuration(stage, q, stored), self.configuration(stage, end, stored)
        )

    def round_off(self, values: FloatArray, q: FloatArray) -> float:
        """Norm of the residual that rounding of positions alone explains [N]."""
        positions = q[: self._split]
        size = max(float(positions.max(initial=0.0)), -float(positions.min(initial=0.0)))
        stiffest = float(values[self._position_slots].max(initial=0.0))
        return 2.0 * _EPS * stiffest * size * sqrt(len(self._position_slots))


def _square(x: FloatArray) -> float:
    return float(x @ x)
