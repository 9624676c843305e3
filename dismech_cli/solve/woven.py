"""Stages solved in one compiled function, without Python between the iterations.

It takes chains and trees whose terms are loops of a driver or constant within a stage, on narrow bands. It
knows full steps alone, with tangents that need no second thought: where a stage is not solved so, it says
nothing, and the stage is solved from the start by what can do more, and ends as it would have ended.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..kernels.linearization import Linearization, all_symmetric
from ..kernels.loop_text import LoopText, map_text
from ..kernels.noted import Block, NotingDriver, NotWovenError
from ..kinematics.rod_frames import EdgeTables, FrameState, TrialFrames, edge_frame, joint_reference_twist
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundTerm, Term
from .integrators import Stage
from .linear import band_loops
from .pattern import SparsityPattern
from .woven_source import woven_source

# Wider bands are faster in LAPACK's blocks, and in larger systems Python hardly counts.
_WIDEST, _MOST = 24, 8000
_EPS: Final = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True)
class Solved:
    """A stage in balance.

    Attributes:
        q: Solution, shape (n,).
        residual: Full residual there, shape (n,).
        iterations: Factorisations done.
        residual_norm: Largest free residual [N].
    """

    q: FloatArray
    residual: FloatArray
    iterations: int
    residual_norm: float


@dataclass(frozen=True, slots=True)
class _Part:
    """A term of the step: a loop, or constant within a stage."""

    term: BoundTerm
    block: Block | None


@dataclass(frozen=True, slots=True)
class _Parts:
    """All of them, those with symmetric tangents apart."""

    symmetric: list[_Part]
    general: list[_Part]

    @property
    def blocks(self) -> list[Block | None]:
        """Their loops."""
        return [part.block for part in (*self.symmetric, *self.general)]

    def text(self, *, framed: bool) -> tuple[LoopText, tuple[LoopText, ...]]:
        """The module of the step and those that it runs."""
        blocks = [part.block for part in self.symmetric]
        drags = [part.block for part in self.general if part.block is not None]
        carry = (map_text(edge_frame, 10, 12), map_text(joint_reference_twist, 13, 1)) if framed else None
        source = woven_source(blocks, drags, carry)
        used = (*(block.text for block in (*blocks, *drags) if block is not None), *(carry or ()))
        return LoopText.of(band_loops.cholesky, "step", source, "solve"), used


class Woven:
    """The compiled step of a system."""

    def __init__(
        self,
        model: Model,
        pattern: SparsityPattern,
        tables: EdgeTables,
        driver: NotingDriver,
        parts: _Parts,
        solve: Callable[..., Any],
    ) -> None:
        """Prepare what does not change from stage to stage; see :func:`weave`."""
        self._solve, self._driver, self._tables = solve, driver, tables
        both = (*parts.symmetric, *parts.general)
        self._loops = [part.term for part in both if part.block is not None]
        self._constant = [part.term for part in both if part.block is None]
        self._into = Linearization.of(model.dofs.n, 1)
        self._rows = np.zeros((len(self._constant), model.dofs.n))
        self._no_frames = TrialFrames(model.frames.rest(model.rest), np.empty(0))
        self._mass, self._split, self._length = model.mass, model.dofs.n_positions, model.length
        self._place(pattern, parts.blocks)

    def _place(self, pattern: SparsityPattern, blocks: Sequence[Block | None]) -> None:
        general = not pattern.symmetric
        width, m = pattern.bandwidth, pattern.m
        rows, columns = pattern.rows, pattern.indices
        step = 3 * width + 1 if general else width + 1
        places = np.append(rows * step + columns - rows + (width if general else 0), m * step)
        self._width, self._diagonal = width, _unsigned(places[pattern.diagonal])
        lower, upper = pattern.mirror() if general else (np.empty(0, dtype=np.int64),) * 2
        self._mirror = (_unsigned(places[lower]), _unsigned(places[upper]))
        self._free = pattern.free
        self._at_node = pattern.free < self._split
        self._rounding = 2.0 * _EPS * sqrt(int(self._at_node.sum()))
        self._fixed = [
            (tuple(map(_unsigned, block.indices)), tuple(_unsigned(places[slots]) for slots in block.slots))
            for block in blocks
            if block is not None
        ]

    def solve(
        self, stage: Stage, stored: FrameState, guess: FloatArray, limit: int, tolerance: float, extent: float
    ) -> Solved | None:
        """Solve a stage; None where that takes more than full steps.

        Args:
            stage: What is solved.
            stored: Frames at the start of the step.
            guess: First guess, prescribed values in place, shape (n,).
            limit: Most factorisations.
            tolerance: Of the residual, see :class:`.problem.NewtonSettings`.
            extent: Size of the rest shape [m].
        """
        q, w = guess.copy(), stage.weights
        c = Configuration(stage.t_stage, q, stage.v0, self._no_frames, stage.inputs)
        for row, term in zip(self._rows, self._constant, strict=True):
            row[:] = 0.0
            term.add_residual(c, row)
        self._driver.calls.clear()
        for term in self._loops:
            term.add_linearization(c, self._into)
        arguments: list[Any] = []
        for call, (indices, slots) in zip(self._driver.calls, self._fixed, strict=True):
            arguments += (call.parameters, indices, slots)
        iterations, norm, r = self._solve(
            q,
            (w.q, w.v, w.a, tolerance, self._length, extent, self._rounding),
            limit,
            self._split,
            (stage.q0, stage.v0, stage.a0),
            self._mass,
            self._rows,
            self._free,
            self._at_node,
            self._width,
            self._diagonal,
            self._mirror,
            self._frames(stored),
            *arguments,
        )
        return None if iterations < 0 else Solved(q, r, iterations, norm)

    def _frames(self, stored: FrameState) -> tuple[Any, ...]:
        t = self._tables
        if not len(t.angles):
            return ()
        state = (stored.tangent, stored.director, stored.reference_twist)
        return (t.tails, t.heads, t.angles, t.joint_edges, t.joint_signs, *map(np.ascontiguousarray, state))


def weave(model: Model, pattern: SparsityPattern, at: Configuration) -> Woven | None:
    """The compiled step of a model on a pattern; None where it has none.

    Args:
        model: What is stepped.
        pattern: Its free DOFs.
        at: Some configuration.
    """
    tables = model.frames.tables
    if pattern.bandwidth > _WIDEST or pattern.m > _MOST or tables is None or model.changing:
        return None
    if model.driver.compiled(band_loops.cholesky) is None:
        return None
    noting, parts = NotingDriver(), _Parts([], [])
    for term in model.terms:
        side = parts.symmetric if all_symmetric(term.couplings) else parts.general
        part = _part(pattern, noting, term, at)
        if part is None:
            return None
        side.append(part)
    if pattern.symmetric == bool(parts.general):
        return None
    solve = model.driver.woven(*parts.text(framed=len(tables.angles) > 0))
    return None if solve is None else Woven(model, pattern, tables, noting, parts, solve)


def _part(pattern: SparsityPattern, noting: NotingDriver, term: Term, at: Configuration) -> _Part | None:
    """A term as a part of the step; None where it can be none.

    It can where it runs one loop at the point that it is given and adds nothing itself, or where it has no
    tangent, so that it depends on neither positions nor velocities.
    """
    noting.calls.clear()
    into = Linearization.of(len(at.q), pattern.slots)
    try:
        bound = term.bind(pattern, noting)
        bound.add_linearization(at, into)
    except NotWovenError:
        return None
    if into.rank_ones or into.stiffness.any() or into.damping.any():
        return None
    if not noting.calls:
        constant = not term.couplings and not term.velocity_dependent
        return _Part(bound, None) if constant else None
    (call, *others) = noting.calls
    here = (call.q is None or call.q is at.q) and (call.v is None or call.v is at.v)
    alone = not others and here and not into.residual.any()
    return _Part(bound, call.block) if alone else None


def _unsigned(indices: IntArray) -> NDArray[np.uint32]:
    return np.ascontiguousarray(indices, dtype=np.uint32)
