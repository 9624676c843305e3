"""Slopes of the balance of a stage at its solution, to positions and velocities of all DOFs.

Newton's method is content with a tangent that leads to the balance; a derivative of the run needs the true
slope. They differ where frames of rods are carried: kernels give the second variation as if the frames were
stored at the trial point. Two parts are missing, both of first order in the motion of a step:

* holonomy: transport from the stored tangent turns the frame as the tangent varies
  (``kinematics/turning.py``), and each turn of it acts as its angle does, K_theta d(sigma);
* of two variations of a tangent t the frame knows the order: where an edge carries the moment m about
  itself, the forces on head and tail vary by +- (m / 2 L) t x dt more than the symmetric tangent says;
  and a viscous stress meets a rate that varies as if the angle turned by dv.(t x dt) / 2 L more, with the
  velocity dv of the head less that of the tail.

Kernels that transport frames themselves, as those of free mid-edge normals do, have both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from ..arrays import BoolArray, FloatArray, IntArray
from ..kernels.linearization import Linearization, RankOne, all_symmetric
from ..kinematics.turning import TurningEdges
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundTerm
from .integrators import Weights
from .linear.choice import LINEAR_SOLVERS, choose_solver
from .linear.factors import Factors
from .linear.updated import UpdatedFactors
from .pattern import SparsityPattern


@dataclass(frozen=True, slots=True)
class Slopes:
    """Slopes of r(q, v) at a trial point, all DOFs by all DOFs.

    Attributes:
        stiffness: dr/dq, in the order of the pattern, shape (n, n).
        damping: dr/dv likewise.
        mass: Diagonal of the mass matrix, shape (n,).
        rank_ones: Slopes outside the pattern.
        by_turn: dr/dsigma of each of the turning edges, rows in the order of the pattern, shape (n, E).
        order: Global DOF of each row and column, shape (n,).
    """

    stiffness: csr_matrix
    damping: csr_matrix
    mass: FloatArray
    rank_ones: tuple[RankOne, ...]
    by_turn: tuple[csr_matrix, ...]
    order: IntArray

    def times(self, dq: FloatArray, dv: FloatArray, da: FloatArray) -> FloatArray:
        """K dq + C dv + M da, shape (n, P) as all of these."""
        out = np.empty_like(dq)
        out[self.order] = self.stiffness @ dq[self.order] + self.damping @ dv[self.order]
        for one in self.rank_ones:
            out += np.multiply.outer(one.column, one.by_q @ dq + one.by_v @ dv)
        out += self.mass[:, None] * da
        return out

    def transposed(self, mu: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """K^T mu, C^T mu and M mu, each of shape (n,)."""
        q, v, ordered = np.empty_like(mu), np.empty_like(mu), mu[self.order]
        q[self.order] = self.stiffness.T @ ordered
        v[self.order] = self.damping.T @ ordered
        for one in self.rank_ones:
            size = float(one.column @ mu)
            q += size * one.by_q
            v += size * one.by_v
        return q, v, self.mass * mu

    def turned(self, turns: Sequence[FloatArray]) -> FloatArray:
        """Change of the residual as frames turn, shape (n, P) for turns of shape (E, P)."""
        rows = sum(slope @ turn for slope, turn in zip(self.by_turn, turns, strict=True))
        out = np.empty_like(rows)
        out[self.order] = rows
        return np.asarray(out)

    def turned_transposed(self, mu: FloatArray) -> tuple[FloatArray, ...]:
        """The same transposed, each of shape (E,)."""
        return tuple(slope.T @ mu[self.order] for slope in self.by_turn)


class Slope:
    """Finds slopes of one model, bound once to a pattern of all its DOFs with both triangles.

    Attributes:
        model: The semi-discrete system.
        pattern: The pattern.
        terms: Its terms, bound.
    """

    def __init__(self, model: Model) -> None:
        """Bind all terms.

        Args:
            model: The semi-discrete system, without terms whose stencils come and go.
        """
        self.model = model
        everything = np.ones(model.dofs.n, dtype=np.bool_)
        pattern = _pattern(model, everything)
        self.pattern = pattern
        self._lower, self._upper = pattern.mirror()
        self._energies: list[BoundTerm] = []
        self._symmetric: list[BoundTerm] = []
        self._rates: list[BoundTerm] = []
        self._general: list[BoundTerm] = []
        self.terms = tuple(term.bind(pattern, model.driver) for term in model.terms)
        for term, bound in zip(model.terms, self.terms, strict=True):
            if term.velocity_dependent:
                self._rates.append(bound)
            elif not all_symmetric(term.couplings):
                self._general.append(bound)
            elif bound.potential is None:
                self._symmetric.append(bound)
            else:
                self._energies.append(bound)
        self._into = Linearization.of(model.dofs.n, pattern.slots)
        self._groups = model.frames.turning
        self._corrections = [_Corrections(pattern, one) for one in self._groups if not one.varied]

    def at(self, c: Configuration, before: FloatArray) -> Slopes:
        """Slopes at a trial point.

        Args:
            c: The trial point.
            before: Shape that its frames were transported from, shape (n,).
        """
        into = self._into
        into.residual[:] = into.stiffness[:] = into.damping[:] = 0.0
        into.rank_ones.clear()
        for term in self._energies:
            term.add_linearization(c, into)
        moments = self._moments()
        for term in self._symmetric:
            term.add_linearization(c, into)
        for values in (into.stiffness, into.damping):
            values[self._lower] = values[self._upper]
        elastic = self._moments()
        for term in self._rates:
            term.add_linearization(c, into)
        moments = [m + total - e for m, total, e in zip(moments, self._moments(), elastic, strict=True)]
        for term in self._general:
            term.add_linearization(c, into)
        stiffness = into.stiffness.copy()
        for correction, moment in zip(self._corrections, moments, strict=True):
            correction.add(stiffness, into, moment, before, c)
        plain = self.pattern.csr(into.stiffness)
        columns = tuple(plain[:, self.pattern.order[one.angles]] for one in self._groups)
        return Slopes(
            self.pattern.csr(stiffness),
            self.pattern.csr(into.damping.copy()),
            self.model.mass,
            tuple(into.rank_ones),
            columns,
            self.pattern.free,
        )

    def _moments(self) -> list[FloatArray]:
        """Moments that edges carry about themselves, of all terms added so far [N m]."""
        return [self._into.residual[one.edges.angles] for one in self._corrections]


class Balance:
    """Solves the linearised balance of the free DOFs of a stage."""

    def __init__(self, slope: Slope, free: BoolArray) -> None:
        """Choose a linear solver.

        Args:
            slope: The model.
            free: Mask of the free DOFs, shape (n,).
        """
        whole = slope.pattern
        rows, columns = whole.free[whole.rows], whole.free[whole.indices]
        self._pattern = _pattern(slope.model, free)
        self.free = self._pattern.free
        self._slots = self._pattern.slots_of(rows, columns)
        self._mass = np.zeros(self._pattern.slots)
        self._mass[self._pattern.diagonal] = slope.model.mass[self.free]
        self._solver = LINEAR_SOLVERS[choose_solver(self._pattern)](self._pattern)

    def factorize(self, slopes: Slopes, w: Weights) -> Factors:
        """Factors of a M + v C + q K on the free DOFs.

        Raises:
            FactorizationError: The matrix is singular: the state has no derivative.
        """
        values = w.a * self._mass
        values[self._slots] += w.q * slopes.stiffness.data + w.v * slopes.damping.data
        factors = self._solver.factorize(values)
        if not slopes.rank_ones:
            return factors
        columns = np.stack([one.column for one in slopes.rank_ones], axis=1)
        rows = np.stack([w.q * one.by_q + w.v * one.by_v for one in slopes.rank_ones], axis=1)
        return UpdatedFactors(factors, columns[self.free], rows[self.free])


def _pattern(model: Model, free: BoolArray) -> SparsityPattern:
    """Both triangles over some DOFs, given as a mask (n,)."""
    couplings = [coupling for term in model.terms for coupling in term.couplings]
    return SparsityPattern.build(model.dofs, free, couplings, symmetric=False)


class _Corrections:
    """What the tangents of kernels leave out at the edges of rods; see the module."""

    def __init__(self, pattern: SparsityPattern, edges: TurningEdges) -> None:
        self.edges = edges
        angles = pattern.order[edges.angles]
        edge_of = np.full(pattern.m, -1)
        edge_of[angles] = np.arange(len(angles))
        self._by_angle = np.flatnonzero(edge_of[pattern.indices] >= 0)
        self._edge = edge_of[pattern.indices[self._by_angle]]
        rows = pattern.free[pattern.rows[self._by_angle]]
        ends = np.stack((edges.heads, edges.tails))
        # every clique that holds an angle holds both nodes of its edge: all these entries are there; slots of
        # (row, component of an end), shape (2, 3, K); and (component, component), (2, 2, 3, 3, E)
        self._holonomy = pattern.slots_of(rows[None, None], ends[:, :, self._edge])
        self._moment = pattern.slots_of(ends[:, None, :, None], ends[None, :, None, :])
        self._sign = np.array([1.0, -1.0])

    def add(
        self,
        stiffness: FloatArray,
        plain: Linearization,
        moment: FloatArray,
        before: FloatArray,
        c: Configuration,
    ) -> None:
        """Add all parts to a stiffness (slots,).

        Args:
            stiffness: What is to be mended.
            plain: What the kernels say.
            moment: Moments of the edges about themselves [N m], shape (E,).
            before: Shape that frames were transported from, shape (n,).
            c: The trial point.
        """
        e, spin = self.edges.along(c.q), self.edges.along(c.v)
        length = np.sqrt((e * e).sum(axis=0))
        _, by_edge = self.edges.holonomy(before, c.q)
        by_rate = 0.5 * np.cross(spin, e, axis=0) / length**3
        turned = plain.stiffness[self._by_angle] * by_edge[:, self._edge]
        turned += plain.damping[self._by_angle] * by_rate[:, self._edge]
        values = self._sign[:, None, None] * turned
        stiffness += np.bincount(self._holonomy.ravel(), values.ravel(), minlength=len(stiffness))
        x, y, z = 0.5 * moment / length**3 * e
        zero = np.zeros_like(x)
        cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]])
        values = (self._sign[:, None] * self._sign)[:, :, None, None, None] * cross
        stiffness += np.bincount(self._moment.ravel(), values.ravel(), minlength=len(stiffness))
