"""What tangents of kernels leave out at the edges of rods, whose frames are carried from step to step.

Kernels give the second variation as if the frames were stored at the trial point. Two parts are missing,
both of first order in the motion of a step:

* holonomy: transport from the stored tangent turns the frame as the tangent varies
  (``kinematics/turning.py``), and each turn of it acts as its angle does, K_theta d(sigma);
* of two variations of a tangent t the frame knows the order: where an edge carries the moment m about
  itself, the forces on head and tail vary by +- (m / 2 L) t x dt more than the symmetric tangent says;
  and a viscous stress meets a rate that varies as if the angle turned by dv.(t x dt) / 2 L more, with the
  velocity dv of the head less that of the tail.

Kernels that transport frames themselves, as those of free mid-edge normals do, have both.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kinematics.turning import Holonomy, TurningEdges, crossed
from ..model.configuration import Configuration
from .pattern import SparsityPattern
from .turn_loops import mend

_SIGN = np.array([1.0, -1.0])


class Carried:
    """The parts that are missing at edges of one kind."""

    def __init__(
        self, pattern: SparsityPattern, edges: TurningEdges, turning: IntArray, driver: Driver
    ) -> None:
        """Find their places.

        Args:
            pattern: Of all DOFs, with both triangles.
            edges: The edges.
            turning: Numbers of the terms whose moments about edges count, shape (K,).
            driver: Compiles.
        """
        self._edges, self._turning = edges, turning
        self._mend = driver.compiled(mend)
        angles = pattern.order[edges.angles]
        edge_of = np.full(pattern.m, -1)
        edge_of[angles] = np.arange(len(angles))
        self._by_angle = np.flatnonzero(edge_of[pattern.indices] >= 0)
        self._edge = edge_of[pattern.indices[self._by_angle]]
        rows = pattern.free[pattern.rows[self._by_angle]]
        ends = np.stack((edges.heads, edges.tails))
        # every clique that holds an angle holds both nodes of its edge: all these entries are there; slots of
        # (row, component of an end), shape (2, 3, K); and (component, component), (2, 2, 3, 3, E)
        holonomy = pattern.slots_of(rows[None, None], ends[:, :, self._edge])
        moment = pattern.slots_of(ends[:, None, :, None], ends[None, :, None, :])
        self._places = (self._by_angle, self._edge, holonomy, moment)
        # what each slot gets: of the turned entries (3, K), and of half the moments along the edges (3, E)
        many = len(self._by_angle)
        into = [holonomy.ravel()]
        source = [np.tile(np.arange(3 * many), 2)]
        signs = [np.repeat(_SIGN, 3 * many)]
        for a, b in ((0, 1), (1, 2), (2, 0)):
            (c,) = {0, 1, 2} - {a, b}
            for row, column, sign in ((a, b, -1.0), (b, a, 1.0)):
                into.append(moment[:, :, row, column].ravel())
                source.append(np.tile(3 * many + c * len(angles) + np.arange(len(angles)), 4))
                signs.append(np.repeat(sign * np.multiply.outer(_SIGN, _SIGN).ravel(), len(angles)))
        self._slots, places = np.unique(np.concatenate(into), return_inverse=True)
        entries = (np.concatenate(signs), (places, np.concatenate(source)))
        self._sums = csr_matrix(entries, shape=(len(self._slots), 3 * (many + len(angles))))

    def add(
        self,
        stiffness: FloatArray,
        damping: FloatArray,
        residuals: FloatArray,
        holonomy: Holonomy,
        k: int,
        c: Configuration,
    ) -> None:
        """Add all parts to a stiffness (slots,).

        Args:
            stiffness: What kernels say, to be mended.
            damping: What they say of velocities, shape (slots,), or (0,) for nothing.
            residuals: Residual of each term, shape (T, n).
            holonomy: Of the frames, on ways to trial points.
            k: Which of them this is.
            c: The trial point.
        """
        after, edge, length = holonomy.after[k], holonomy.edge[k], holonomy.length[k]
        if self._mend is not None:
            edges = self._edges
            self._mend(
                stiffness,
                damping,
                residuals,
                self._turning,
                (edges.heads, edges.tails, edges.angles),
                c.v,
                (after, edge, length),
                self._places,
            )
            return
        turned = after.take(self._edge, axis=1)
        turned *= stiffness.take(self._by_angle)
        half = 0.5 / length**3
        if damping.size:
            by_rate = half * crossed(self._edges.along(c.v), edge)
            turned += damping.take(self._by_angle) * by_rate.take(self._edge, axis=1)
        moment = residuals[self._turning[:, None], self._edges.angles].sum(axis=0)
        turns = half * moment * edge
        stiffness[self._slots] += self._sums @ np.concatenate((turned.ravel(), turns.ravel()))
