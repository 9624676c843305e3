"""Residual and tangent of a stage, added up term by term in buffers that are made once."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Linearization, RankOne, all_symmetric
from ..kinematics.rod_frames import FramesAt
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundTerm
from .overlay import Adding, Overlay
from .pattern import SparsityPattern
from .stage import Stage, Weights


@frozen
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
        frames: Those at the trial point; nobody overwrites them.
    """

    residual: FloatArray
    values: FloatArray
    columns: FloatArray
    rows: FloatArray
    force: float
    moment: float
    frames: FramesAt


@frozen
class Terms:
    """Terms bound to a pattern, those with symmetric tangents apart: they fill one triangle.

    Attributes:
        symmetric: Those.
        general: The others.
        changing: How those that come and go are added.
    """

    symmetric: tuple[BoundTerm, ...]
    general: tuple[BoundTerm, ...]
    changing: Adding

    @classmethod
    def bound(cls, model: Model, pattern: SparsityPattern, driver: Driver, changing: Adding) -> Terms:
        """Bind the terms of a model that stay."""
        sides: tuple[list[BoundTerm], list[BoundTerm]] = ([], [])
        for term in model.terms:
            sides[not all_symmetric(term.couplings)].append(term.bind(pattern, driver))
        return cls(tuple(sides[0]), tuple(sides[1]), changing)


class Assembly:
    """The buffers of a model on its base pattern."""

    def __init__(self, model: Model, base: SparsityPattern) -> None:
        self._mass = model.mass
        self._has_mass = bool(model.mass.any())
        self._damped = any(t.velocity_dependent for t in model.terms)
        self._split = model.dofs.n_positions
        self._free, self._diagonal = base.free, base.diagonal
        # one triangle is mirrored before unsymmetric tangents are added
        self._mirror = None if base.symmetric else base.mirror()
        self._buffers = Linearization.of(model.dofs.n, base.slots)
        self._inertia = np.zeros(base.slots)
        self._inertia_slope = 0.0
        self._nothing = np.empty((base.m, 0))

    def add_up(
        self, terms: Terms, overlay: Overlay | None, c: Configuration, stage: Stage, q: FloatArray
    ) -> Linearized:
        """Residual and tangent of a stage, with the sizes that say when the residual is small.

        Args:
            terms: Those that stay.
            overlay: Those that come and go, in place for the trial point.
            c: The trial point of the stage.
            stage: What is solved.
            q: Its unknown, shape (n,).
        """
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
            # not a measure of what is small: a barrier that something touches would dwarf all other forces
            overlay.add(c, terms.changing, into.residual, into.rank_ones)
            values = overlay.total(values, w.q, w.v)
        if self._has_mass:
            inertia = self._mass * stage.acceleration(q)
            head, tail = inertia[: self._split], inertia[self._split :]
            force, moment = max(force, _square(head)), max(moment, _square(tail))
            into.residual += inertia
        columns, rows = self._outside(into.rank_ones, w)
        return Linearized(into.residual, values, columns, rows, sqrt(force), sqrt(moment), c.frames)

    def _outside(self, rank_ones: Sequence[RankOne], w: Weights) -> tuple[FloatArray, FloatArray]:
        """Columns and rows of the tangents outside the pattern, each of shape (m, k)."""
        if not rank_ones:
            return self._nothing, self._nothing
        columns = np.stack([one.column for one in rank_ones], axis=1)
        rows = np.stack([w.q * one.by_q + w.v * one.by_v for one in rank_ones], axis=1)
        return columns[self._free], rows[self._free]

    def _tangent_of_inertia(self, w: Weights) -> FloatArray:
        """Tangent values of the inertia before they are multiplied by the weight of positions."""
        if self._inertia_slope != w.a / w.q:
            self._inertia_slope = w.a / w.q
            self._inertia[self._diagonal] = self._inertia_slope * self._mass[self._free]
        return self._inertia


def _square(x: FloatArray) -> float:
    return float(x @ x)
