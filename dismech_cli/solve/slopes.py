"""Slopes of the balance of a stage at its solution, to positions and velocities of all DOFs.

Newton's method is content with a tangent that leads to the balance; a derivative of the run needs the true
slope, held DOFs included. What kernels leave out of it where frames are carried is in ``carried.py``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix

from ..arrays import BoolArray, FloatArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, RankOne, all_symmetric
from ..kinematics.turning import Holonomy
from ..model.configuration import Configuration
from ..model.model import Model
from .anew import Anew
from .carried import Carried
from .linear.choice import LINEAR_SOLVERS, choose_solver
from .linear.factors import Factors
from .linear.updated import UpdatedFactors
from .pattern import SparsityPattern
from .stage import Weights
from .sweep import mirrored_by, sweep_of


class Entries:
    """A matrix of all DOFs whose entries change in their places; SciPy is slow to make one."""

    def __init__(self, pattern: SparsityPattern) -> None:
        self._order, self._symmetric = pattern.free, pattern.symmetric
        self.values = np.zeros(pattern.slots)
        self._matrix = pattern.csr(self.values)
        self._transposed = self._matrix.T
        self._diagonal = pattern.diagonal

    def of(self, values: FloatArray) -> Entries:
        """Itself, with some values (slots,)."""
        self.values[:] = values
        return self

    def times(self, x: FloatArray) -> FloatArray:
        """The product with x, shape (n,) or (n, P)."""
        return self._product(self._matrix, self._transposed, x)

    def transposed(self, x: FloatArray) -> FloatArray:
        """The product of the transpose."""
        return self._product(self._transposed, self._matrix, x)

    def _product(
        self, matrix: csr_matrix | csc_matrix, mirror: csr_matrix | csc_matrix, x: FloatArray
    ) -> FloatArray:
        ordered, out = x[self._order], np.empty_like(x)
        y: FloatArray = matrix @ ordered
        if self._symmetric:
            y += mirror @ ordered
            y -= (self.values[self._diagonal] * ordered.T).T
        out[self._order] = y
        return out


@frozen
class Slopes:
    """Slopes of r(q, v) at a trial point, all DOFs by all DOFs; good until the next are asked for.

    Attributes:
        stiffness: Entries of dr/dq, shape (slots,).
        damping: dr/dv; None where nothing depends on velocities.
        rank_ones: Slopes outside the pattern.
    """

    stiffness: FloatArray
    damping: Entries | None
    rank_ones: tuple[RankOne, ...]

    @property
    def damped(self) -> bool:
        """Whether anything depends on velocities."""
        return self.damping is not None or bool(self.rank_ones)

    def by_velocity(self, x: FloatArray) -> FloatArray:
        """C x, shape (n, P)."""
        out = np.zeros_like(x) if self.damping is None else self.damping.times(x)
        for one in self.rank_ones:
            out += np.multiply.outer(one.column, one.by_v @ x)
        return out

    def by_velocity_transposed(self, mu: FloatArray) -> FloatArray:
        """C^T mu, shape (n,)."""
        out = np.zeros_like(mu) if self.damping is None else self.damping.transposed(mu)
        for one in self.rank_ones:
            out += float(one.column @ mu) * one.by_v
        return out


@frozen
class SlopeRows:
    """Slopes at C trial points; good until the next are found.

    Attributes:
        residuals: Residual of each term, shape (C, T, n).
        stiffness: Entries of dr/dq, shape (C, slots).
        damping: Those of dr/dv, shape (C, slots); (C, 0) where nothing depends on velocities.
        rank_ones: Slopes outside the pattern at each of them.
        entries: Makes a matrix of entries.
    """

    residuals: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    rank_ones: tuple[tuple[RankOne, ...], ...]
    entries: Entries

    @property
    def plain(self) -> bool:
        """Whether none is outside the pattern."""
        return not any(self.rank_ones)

    def at(self, k: int) -> Slopes:
        """Those at one of them."""
        damping = self.entries.of(self.damping[k]) if self.damping.size else None
        return Slopes(self.stiffness[k], damping, self.rank_ones[k])


class Slope:
    """Finds slopes of one model, bound once to a pattern of all its DOFs.

    Attributes:
        model: The semi-discrete system.
        sweeper: Runs sweeps.
        pattern: The pattern, of one triangle where all slopes are symmetric.
        terms: Its terms, bound.
        bytes: What a trial point takes.
    """

    def __init__(self, model: Model, sweeper: Driver, met: Sequence[Coupling]) -> None:
        """Bind all terms.

        Args:
            model: The semi-discrete system.
            sweeper: Runs sweeps.
            met: What comes to be coupled wherever slopes are asked for.
        """
        self.model, self.sweeper, self._met = model, sweeper, met
        self._anew = Anew(model.changing, model.driver)
        self.pattern = pattern = self.pattern_of(np.ones(model.dofs.n, dtype=np.bool_))
        if not pattern.symmetric:
            self._lower, self._upper = pattern.mirror()
            self._mirrored = mirrored_by(sweeper)
        self.terms = tuple(term.bind(pattern, model.driver) for term in model.terms)
        self._entries = Entries(pattern)
        self._damped = any(term.velocity_dependent for term in model.terms) or any(
            term.velocity_dependent for term in model.changing
        )
        one_sided = [all_symmetric(term.couplings) for term in model.terms]
        numbered = list(enumerate(zip(self.terms, one_sided, strict=True)))
        self._one_sided = [(k, term) for k, (term, one) in numbered if one]
        self._two_sided = [(k, term) for k, (term, one) in numbered if not one]
        turning = [
            k
            for k, (bound, one) in numbered
            if model.terms[k].velocity_dependent or (one and bound.potential is not None)
        ]
        self._carried = [
            (k, Carried(pattern, one, np.array(turning, dtype=np.int64), sweeper))
            for k, one in enumerate(model.frames.turning)
            if not one.varied
        ]
        self.bytes = 8 * (pattern.slots * (1 + self._damped) + len(self.terms) * model.dofs.n)
        self._make_room(1)

    def _make_room(self, count: int) -> None:
        """Make room for some trial points; forces of what comes and goes are no multiples of anything."""
        n, slots = self.model.dofs.n, self.pattern.slots
        self._residuals = np.zeros((count, len(self.terms), n))
        self._stiffness = np.zeros((count, slots))
        self._damping = np.zeros((count, slots if self._damped else 0))
        unmoved, unshared = np.zeros(slots), np.zeros(n)
        self._into: list[list[Linearization]] = []
        for k in range(count):
            stiffness, ones = self._stiffness[k], list[RankOne]()
            damping = self._damping[k] if self._damped else unmoved
            rows = (*self._residuals[k], unshared)
            self._into.append([Linearization(row, stiffness, damping, ones) for row in rows])

    def pattern_of(self, free: BoolArray) -> SparsityPattern:
        """The pattern over some DOFs, given as a mask (n,); of one triangle if no slope needs both."""
        model = self.model
        couplings = [coupling for term in model.terms for coupling in term.couplings]
        carried = any(not one.varied for one in model.frames.turning)
        symmetric = all_symmetric(couplings) and all(term.symmetric for term in model.changing)
        return SparsityPattern.build(
            model.dofs, free, [*couplings, *self._met], symmetric=symmetric and not carried
        )

    def at(self, points: Sequence[Configuration], holonomies: Sequence[Holonomy]) -> SlopeRows:
        """Slopes at trial points.

        Args:
            points: The C trial points.
            holonomies: Of the frames of each kind of edges, on the ways to them.
        """
        count = len(points)
        if count > len(self._into):
            self._make_room(count)
        rows = self._residuals[:count], self._stiffness[:count], self._damping[:count]
        for row in rows:
            row[:] = 0.0
        for k, c in enumerate(points):
            self._add(k, c, holonomies)
        ones = tuple([tuple(into[-1].rank_ones) for into in self._into[:count]])
        return SlopeRows(*rows, ones, self._entries)

    def _add(self, k: int, c: Configuration, holonomies: Sequence[Holonomy]) -> None:
        """Slopes at one of the trial points."""
        into, pattern = self._into[k], self.pattern
        stiffness, damping = self._stiffness[k], self._damping[k]
        into[-1].rank_ones.clear()
        for index, term in self._one_sided:
            term.add_linearization(c, into[index])
        if self.model.changing:
            self._anew.place(c, pattern)
            self._anew.add(c, into[-1], symmetric=True)
        if not pattern.symmetric:
            self._mirrored(stiffness, self._lower, self._upper)
            if self._damped:
                self._mirrored(damping, self._lower, self._upper)
        for index, term in self._two_sided:
            term.add_linearization(c, into[index])
        if self.model.changing:
            self._anew.add(c, into[-1], symmetric=False)
        for index, carried in self._carried:
            carried.add(stiffness, damping, self._residuals[k], holonomies[index], k, c)


class Balance:
    """Solves the linearised balance of the free DOFs of a stage, J = a M + v C + q K.

    Attributes:
        free: The free DOFs in matrix order, shape (m,).
        sweep: Goes through stages in one compiled function; None where that cannot be.
    """

    def __init__(self, slope: Slope, free: BoolArray) -> None:
        """Choose a linear solver.

        Args:
            slope: The model.
            free: Mask of the free DOFs, shape (n,).
        """
        whole, model = slope.pattern, slope.model
        pattern = whole if free.all() else slope.pattern_of(free)
        self.free = pattern.free
        self._total = Entries(whole)
        self._diagonal, self._mass = whole.diagonal, model.mass[whole.free]
        # the place in the whole of each entry between free DOFs
        rows, columns = pattern.free[pattern.rows], pattern.free[pattern.indices]
        find = whole.symmetric_slots if whole.symmetric else whole.slots_of
        slots = find(rows, columns)
        self._places = np.append(slots, whole.nnz)
        self.sweep = sweep_of(whole, pattern, slots, model, slope.sweeper)
        self._solver = LINEAR_SOLVERS[choose_solver(pattern)](pattern)

    def factorize(self, slopes: Slopes, w: Weights) -> Factors:
        """Factors of J on the free DOFs.

        Raises:
            FactorizationError: The matrix is singular: the state has no derivative.
        """
        self._add_up(slopes, w)
        factors = self._solver.factorize(self._total.values.take(self._places))
        if not self._rank_ones:
            return factors
        columns, rows = (np.stack(vectors, axis=1) for vectors in zip(*self._rank_ones, strict=True))
        return UpdatedFactors(factors, columns[self.free], rows[self.free])

    def _add_up(self, slopes: Slopes, w: Weights) -> None:
        values = self._total.values
        np.multiply(slopes.stiffness, w.q, out=values)
        if slopes.damping is not None:
            values += w.v * slopes.damping.values
        values[self._diagonal] += w.a * self._mass
        self._rank_ones = [(one.column, w.q * one.by_q + w.v * one.by_v) for one in slopes.rank_ones]

    def stiff(self, slopes: Slopes, x: FloatArray) -> FloatArray:
        """K x of all DOFs, shape (n, P)."""
        self._add_up(slopes, Weights(1.0, 0.0, 0.0))
        return self.times(x)

    def stiff_transposed(self, slopes: Slopes, mu: FloatArray) -> FloatArray:
        """K^T mu of all DOFs, shape (n,)."""
        self._add_up(slopes, Weights(1.0, 0.0, 0.0))
        return self.transposed(mu)

    def times(self, x: FloatArray) -> FloatArray:
        """J x of all DOFs, as last factorised, shape (n, P)."""
        out = self._total.times(x)
        for column, row in self._rank_ones:
            out += np.multiply.outer(column, row @ x)
        return out

    def transposed(self, mu: FloatArray) -> FloatArray:
        """J^T mu of all DOFs, shape (n,)."""
        out = self._total.transposed(mu)
        for column, row in self._rank_ones:
            out += float(column @ mu) * row
        return out
