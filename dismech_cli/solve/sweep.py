"""Sweeps of derivatives through stages in one compiled function, where matrices are narrow bands.

Such a sweep knows the plain case: where the matrix is not positive definite, or a solution not good at once,
it says nothing, and the stage is gone through by what can do more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kinematics.turning import Holonomy, TurningEdges
from . import sweep_loops, sweep_matrix, turn_loops
from .linear.sided_loops import ABREAST
from .maps import Maps
from .pattern import SparsityPattern

# Wider bands are faster in LAPACK's blocks.
_WIDEST: Final = 24

Block: TypeAlias = "tuple[FloatArray, FloatArray, FloatArray]"
"""Of positions, rates and second rates, each of shape (n, P)."""


Matrix: TypeAlias = tuple[Any, ...]
"""A matrix of all DOFs, as :mod:`.sweep_loops` wants it."""

_NOTHING: Final = np.empty(0)

LOOPS: Final[tuple[Callable[..., Any], ...]] = (
    sweep_loops.go_forward,
    sweep_loops.go_back,
    turn_loops.turn_slopes,
    sweep_loops.weigh,
    turn_loops.mend,
    sweep_matrix.mirror,
)
"""What is compiled for sweeps, whatever the scene."""


def matrix_of(
    pattern: SparsityPattern, stiffness: FloatArray, damping: FloatArray | None, mass: FloatArray
) -> Matrix:
    """Views of entries (slots,), with masses (n,); None where nothing depends on velocities."""
    rates = _NOTHING if damping is None else damping[: pattern.nnz]
    places = (pattern.diagonal, pattern.indptr, pattern.indices, pattern.free)
    return (stiffness[: pattern.nnz], rates, mass, *places)


@dataclass(frozen=True, slots=True)
class Sides:
    """What a stage balances.

    Attributes:
        maps: Maps of the stage.
        matrix: Slopes of the balance.
        held: Held DOFs, shape (K,).
        led: Those whose rates are difference quotients.
        to_trial: How frames turn on the way to the trial point.
        to_end: And to the end.
    """

    maps: Maps
    matrix: Matrix
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
        edges: Sequence[TurningEdges],
        forward: Callable[..., bool],
        back: Callable[..., bool],
    ) -> None:
        """Find the place of each entry in a band; see :func:`sweep_of`."""
        self._symmetric, self._width, self._free = whole.symmetric, free.bandwidth, free.free
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
        nowhere = np.empty((3, 0), dtype=np.int64)
        self._edges = (
            (edges[0].heads, edges[0].tails, edges[0].angles) if edges else (nowhere, nowhere, nowhere[0])
        )

    def forward(
        self,
        s: Sides,
        states: tuple[Block, Block],
        given: FloatArray,
        held_q: FloatArray,
        turns: tuple[FloatArray, ...],
    ) -> tuple[Block, tuple[FloatArray, ...]] | None:
        """Derivatives of state and turns after a stage; None where that takes a second thought.

        Args:
            s: The stage.
            states: Derivative of the start of the step, and that before the stage.
            given: Derivative of the balance at a fixed state, shape (n, P).
            held_q: That of where held DOFs are, shape (K, P).
            turns: That of the turns of frames (E, P).
        """
        sides = given.shape[1]
        room = -(-sides // ABREAST) * ABREAST
        if self._work.shape[1] < room:
            self._work = np.empty((len(self._work), room))
        q, v, a = np.empty((3, *given.shape))
        before = turns[0] if turns else np.empty((0, sides))
        after = np.empty_like(before)
        if not self._forward(
            s.maps.numbers,
            s.maps.slopes,
            *(tuple(map(np.ascontiguousarray, state)) for state in states),
            given.copy(),
            s.held,
            held_q,
            s.led,
            s.matrix,
            self._symmetric,
            self._width,
            (self._places, self._room, self._work, self._free),
            self._edges,
            *_ways(s),
            before,
            (q, v, a),
            after,
        ):
            return None
        return (q, v, a), (after,) if turns else ()

    def back(
        self,
        s: Sides,
        owed: Block,
        turns: tuple[FloatArray, ...],
        start: Block,
        given: FloatArray,
        gradient: FloatArray,
    ) -> tuple[Block, tuple[FloatArray, ...], FloatArray] | None:
        """What is owed to the state before a stage, to turns there, and to where held DOFs are (K,).

        Args:
            s: The stage.
            owed: To the state after it, each of shape (n, 1).
            turns: To the turns there (E,).
            start: To the start of the step; added to.
            given: Derivative of the balance to parameters at a fixed state, shape (n, P).
            gradient: To parameters, shape (P,); added to.
        """
        q, v, a = np.empty((3, *owed[0].shape))
        after = turns[0] if turns else _NOTHING
        before, by_held = np.empty_like(after), np.empty(len(s.held))
        if not self._back(
            s.maps.numbers,
            s.maps.slopes,
            owed,
            after,
            start,
            s.held,
            s.led,
            s.matrix,
            self._symmetric,
            self._width,
            (self._transposed, self._room, self._work[:, :ABREAST].copy(), self._free),
            self._edges,
            *_ways(s),
            given,
            gradient,
            (q, v, a),
            before,
            by_held,
        ):
            return None
        return (q, v, a), (before,) if turns else (), by_held


_NOWHERE: Final = np.empty((3, 0))


def _ways(s: Sides) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    if not s.to_trial:
        return (_NOWHERE, _NOWHERE), (_NOWHERE, _NOWHERE)
    trial, end = s.to_trial[0], s.to_end[0]
    return (trial.before, trial.after), (end.before, end.after)


def sweep_of(
    whole: SparsityPattern,
    free: SparsityPattern,
    slots: IntArray,
    edges: Sequence[TurningEdges],
    driver: Driver,
) -> Sweep | None:
    """The sweep of some free DOFs; None where there is none.

    Args:
        whole: Pattern of all DOFs.
        free: That of the free ones.
        slots: The slot in the whole of each entry between free DOFs, shape (nnz of these,).
        edges: Edges whose frames are carried.
        driver: Compiles.
    """
    if len(edges) > 1 or not 0 < free.bandwidth <= _WIDEST:
        return None
    forward, back = driver.compiled(sweep_loops.go_forward), driver.compiled(sweep_loops.go_back)
    if forward is None or back is None:
        return None
    return Sweep(whole, free, slots, edges, forward, back)


Turned: TypeAlias = Callable[[TurningEdges, FloatArray, FloatArray], Holonomy]
"""Finds how frames of edges turn on the way from shapes (n,) to others."""


def turned_by(driver: Driver) -> Turned:
    """By loops, or in operations on arrays."""
    loop = driver.compiled(turn_loops.turn_slopes)
    if loop is None:
        return TurningEdges.holonomy

    def turned(edges: TurningEdges, q0: FloatArray, q1: FloatArray) -> Holonomy:
        before, after, edge = np.empty((3, *edges.heads.shape))
        length = np.empty(len(edges.angles))
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
"""Sums residuals (T, n) by shares (T, P), with masses (n, P) times accelerations (n,), shape (n, P)."""


def weighed_by(driver: Driver) -> Weighed:
    """By a loop, or in operations on arrays."""
    loop = driver.compiled(sweep_loops.weigh)
    if loop is None:
        return _weighed

    def weighed(residuals: FloatArray, shares: FloatArray, mass: FloatArray, a: FloatArray) -> FloatArray:
        out = np.empty_like(mass)
        loop(residuals, shares, mass, a, out)
        return out

    return weighed


def _weighed(residuals: FloatArray, shares: FloatArray, mass: FloatArray, a: FloatArray) -> FloatArray:
    found: FloatArray = residuals.T @ shares
    found += mass * a[:, None]
    return found
