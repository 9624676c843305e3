"""Sweeps of derivatives through stages in one compiled function, where matrices are narrow bands.

Such a sweep knows the plain case: where the matrix is not positive definite, or a solution not good at once,
it says nothing, and the stage is gone through by what can do more.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kinematics.turning import Holonomy, TurningEdges
from ..model.model import Model
from . import sweep_back, sweep_loops, sweep_matrix, turn_loops
from .linear.sided_loops import ABREAST
from .maps import Maps
from .pattern import SparsityPattern

# Wider bands are faster in LAPACK's blocks.
_WIDEST: Final = 24

LOOPS: Final[tuple[Callable[..., Any], ...]] = (
    sweep_loops.all_forward,
    sweep_back.all_back,
    turn_loops.turn_slopes,
    sweep_loops.weigh,
    turn_loops.mend,
    sweep_matrix.mirror,
)
"""What is compiled for sweeps, whatever the scene."""


@frozen
class Sides:
    """What C stages balance.

    Attributes:
        maps: Maps of the stages of a step.
        stiffness: Entries of dr/dq, shape (C, slots).
        damping: Those of dr/dv, shape (C, slots); (C, 0) where nothing depends on velocities.
        given: Derivative of the balance at a fixed state, shape (C, n, P).
        held: Held DOFs, shape (K,).
        led: Those whose rates are difference quotients.
        to_trial: How frames turn on the way to the trial point.
        to_end: And to the end.
    """

    maps: Maps
    stiffness: FloatArray
    damping: FloatArray
    given: FloatArray
    held: IntArray
    led: IntArray
    to_trial: tuple[Holonomy, ...]
    to_end: tuple[Holonomy, ...]


class Sweep:
    """Goes through stages with some DOFs free."""

    def __init__(
        self,
        whole: SparsityPattern,
        free: SparsityPattern,
        slots: IntArray,
        model: Model,
        forward: Callable[..., int],
        back: Callable[..., int],
    ) -> None:
        """Find the place of each entry in a band; see :func:`sweep_of`."""
        self._forward, self._back = forward, back
        width, rows, columns = free.bandwidth, free.rows, free.indices
        step, first = (width + 1, 0) if whole.symmetric else (2 * width + 1, width)
        entries = (free.m + width) * step + 1
        self._places, self._transposed = np.full((2, whole.nnz), entries - 1)
        self._places[slots] = rows * step + first + columns - rows
        self._transposed[slots] = columns * step + first + rows - columns
        if whole.symmetric:
            self._transposed = self._places
        self._room, self._work = np.empty(entries), np.empty((free.m + width, ABREAST))
        self._rows = (model.mass, whole.diagonal, whole.indptr, whole.indices, whole.free)
        self._shape, self._free = (whole.symmetric, width), free.free
        edges = model.frames.turning
        self._edges = (edges[0].heads, edges[0].tails, edges[0].angles) if edges else _NO_EDGES

    def forward(
        self, s: Sides, states: FloatArray, turns: FloatArray, held_q: FloatArray, first: int, reach: int
    ) -> int:
        """Go forward through stages; the number of that which takes a second thought, or ``reach``.

        Args:
            s: The stages.
            states: Derivative of q, v, a at the start and after each stage, shape (C + 1, 3, n, P); those
                up to the first stage are read, the others written.
            turns: Likewise of the turns of frames, shape (C + 1, E, P).
            held_q: That of where held DOFs are at the end of each of these stages, shape (K, P).
            first: Number of the first stage.
            reach: Number of the stage where this ends.
        """
        sides = states.shape[-1]
        room = -(-sides // ABREAST) * ABREAST
        if self._work.shape[1] < room:
            self._work = np.empty((len(self._work), room))
        return self._forward(
            first,
            reach,
            s.maps.numbers,
            s.maps.slopes,
            states,
            turns,
            s.given,
            s.held,
            held_q,
            s.led,
            (s.stiffness, s.damping, *self._rows),
            *self._shape,
            (self._places, self._room, self._work, self._free),
            self._edges,
            *_ways(s),
        )

    def back(
        self,
        s: Sides,
        owed: FloatArray,
        turns: FloatArray,
        start: FloatArray,
        gradient: FloatArray,
        by_held: FloatArray,
        left: int,
    ) -> int:
        """Go back through stages; how many are left by one that takes a second thought, or none.

        Args:
            s: The stages.
            owed: To q, v, a after them, shape (3, n, 1), then before them; changed in place.
            turns: To the turns of frames (E,), likewise.
            start: To q, v, a at the start of the step that is gone through, shape (3, n, 1), likewise.
            gradient: To parameters, shape (P,); added to.
            by_held: To where held DOFs are at the end of each stage, shape (C, K), written.
            left: How many stages there are.
        """
        return self._back(
            left,
            s.maps.numbers,
            s.maps.slopes,
            owed,
            turns,
            start,
            s.held,
            s.led,
            (s.stiffness, s.damping, *self._rows),
            *self._shape,
            (self._transposed, self._room, self._work[:, :ABREAST].copy(), self._free),
            self._edges,
            *_ways(s),
            s.given,
            gradient,
            by_held,
        )


_NO_DOFS: Final[IntArray] = np.empty((3, 0), dtype=np.int64)
_NO_EDGES: Final = (_NO_DOFS, _NO_DOFS, _NO_DOFS[0])


def _ways(s: Sides) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    if not s.to_trial:
        nowhere = np.empty((len(s.given), 3, 0))
        return (nowhere, nowhere), (nowhere, nowhere)
    trial, end = s.to_trial[0], s.to_end[0]
    return (trial.before, trial.after), (end.before, end.after)


def sweep_of(
    whole: SparsityPattern, free: SparsityPattern, slots: IntArray, model: Model, driver: Driver
) -> Sweep | None:
    """The sweep of some free DOFs; None where there is none.

    Args:
        whole: Pattern of all DOFs.
        free: That of the free ones.
        slots: The slot in the whole of each entry between free DOFs, shape (nnz of these,).
        model: Has the masses, and the edges whose frames are carried.
        driver: Compiles.
    """
    if len(model.frames.turning) > 1 or not 0 < free.bandwidth <= _WIDEST:
        return None
    forward, back = driver.compiled(sweep_loops.all_forward), driver.compiled(sweep_back.all_back)
    if forward is None or back is None:
        return None
    return Sweep(whole, free, slots, model, forward, back)


Turned: TypeAlias = Callable[[TurningEdges, FloatArray, FloatArray], Holonomy]
"""Finds how frames of edges turn on their ways from shapes (C, n) to others."""


def turned_by(driver: Driver) -> Turned:
    """By loops, or in operations on arrays."""
    loop = driver.compiled(turn_loops.turn_slopes)
    if loop is None:
        return TurningEdges.holonomy

    def turned(edges: TurningEdges, q0: FloatArray, q1: FloatArray) -> Holonomy:
        before, after, edge = np.empty((3, len(q0), *edges.heads.shape))
        length = np.empty((len(q0), len(edges.angles)))
        loop(q0, q1, edges.heads, edges.tails, before, after, edge, length)
        return Holonomy(before, after, edge, length)

    return turned


Mirrored: TypeAlias = Callable[[FloatArray, IntArray, IntArray], None]
"""Writes entries of one triangle into the other."""


def mirrored_by(driver: Driver) -> Mirrored:
    """By a loop, or in operations on arrays."""
    loop = driver.compiled(sweep_matrix.mirror)
    return _mirrored if loop is None else loop


def _mirrored(values: FloatArray, to: IntArray, of: IntArray) -> None:
    values[to] = values.take(of)


Weighed: TypeAlias = Callable[[FloatArray, FloatArray, FloatArray, FloatArray], FloatArray]
"""Sums residuals (C, T, n) by shares (T, P), with masses (n, P) times accelerations (C, n), (C, n, P)."""


def weighed_by(driver: Driver) -> Weighed:
    """By a loop, or in operations on arrays."""
    loop = driver.compiled(sweep_loops.weigh)
    if loop is None:
        return _weighed

    def weighed(residuals: FloatArray, shares: FloatArray, mass: FloatArray, a: FloatArray) -> FloatArray:
        out = np.empty((len(residuals), *mass.shape))
        loop(residuals, shares, mass, a, out)
        return out

    return weighed


def _weighed(residuals: FloatArray, shares: FloatArray, mass: FloatArray, a: FloatArray) -> FloatArray:
    found: FloatArray = residuals.swapaxes(1, 2) @ shares
    found += mass * a[:, :, None]
    return found
