"""Stages solved in one compiled function, without Python between the iterations.

Such a step knows full steps alone, with tangents that need no second thought: where a stage is not solved so,
it says nothing, and the stage is solved from the start by what can do more, and ends as it would have ended.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..kernels.linearization import Linearization
from ..kinematics.rod_frames import EdgeTables, FrameState, TrialFrames
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundTerm
from .linear import band_loops
from .pattern import SparsityPattern
from .stage import Stage
from .weaving import Parts, Weaving, weaving

_EPS: Final = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True)
class Solved:
    """A stage in balance.

    Attributes:
        q: Solution, shape (n,).
        residual: Full residual there, shape (n,).
        iterations: Factorisations done.
        residual_norm: Largest free residual [N].
        frames: Frames at the end of the stage.
    """

    q: FloatArray
    residual: FloatArray
    iterations: int
    residual_norm: float
    frames: FrameState


class Woven:
    """The compiled step of a system."""

    def __init__(
        self,
        model: Model,
        pattern: SparsityPattern,
        tables: EdgeTables,
        woven: Weaving,
        solve: Callable[..., Any],
    ) -> None:
        """Prepare what does not change from stage to stage; see :func:`weave`."""
        driver, parts = woven.driver, woven.parts
        self._solve, self._driver, self._tables = solve, driver, tables
        constant = [part.term for part in parts.all if part.block is None]
        self._rows = np.zeros((len(constant), model.dofs.n))
        self._into = Linearization.of(model.dofs.n, 1)
        self._rest = TrialFrames(model.frames.rest(model.rest), np.empty(0))
        self._mass, self._split, self._length = model.mass, model.dofs.n_positions, model.length
        self._place(pattern, parts)
        loops = [part.term for part in parts.all if part.block is not None]
        # the rows and the loops' parameters that change from stage to stage
        self._later_rows = [(row, term) for row, term in zip(self._rows, constant, strict=True)]
        self._later_loops = list(enumerate(loops))
        self._looked = False

    def _place(self, pattern: SparsityPattern, parts: Parts) -> None:
        general = not pattern.symmetric
        width, m = pattern.bandwidth, pattern.m
        rows, columns = pattern.rows, pattern.indices
        step = 3 * width + 1 if general else width + 1
        # the last, beyond the rows of zeros, takes what is fixed
        entries = (m + width) * step + 1
        places = np.append(rows * step + columns - rows + (width if general else 0), entries - 1)
        self._diagonal = _unsigned(places[pattern.diagonal])
        lower, upper = pattern.mirror() if general else (np.empty(0, dtype=np.int64),) * 2
        self._mirror = (_unsigned(places[lower]), _unsigned(places[upper]))
        self._band = (
            np.empty(entries),
            np.empty(entries if parts.damped else 0),
            np.empty(entries + 3 * (m + 2 * width)),
            np.empty(m, dtype=np.int64),
        )
        self._free = pattern.free
        self._at_node = pattern.free < self._split
        self._rounding = 2.0 * _EPS * sqrt(int(self._at_node.sum()))
        self._arguments: list[Any] = []
        for part in parts.all:
            if part.block is not None:
                indices = tuple(map(_unsigned, part.block.indices))
                slots = tuple(_unsigned(places[slots]) for slots in part.block.slots)
                self._arguments += (None, indices, slots)

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
        self._look(stage, q)
        iterations, norm, r, carried, twists = self._solve(
            q,
            (w.q, w.v, w.a, tolerance, self._length, extent, self._rounding),
            limit,
            self._split,
            (stage.q0, stage.v0, stage.a0),
            self._mass,
            self._rows,
            self._free,
            self._at_node,
            self._diagonal,
            self._mirror,
            self._band,
            self._frames(stored),
            *self._arguments,
        )
        if iterations < 0:
            return None
        frames = FrameState(carried[6:9], carried[9:12], twists[0]) if len(self._tables.angles) else stored
        return Solved(q, r, iterations, norm, frames)

    def _look(self, stage: Stage, q: FloatArray) -> None:
        """Ask the terms for their constants and parameters in a stage; what is steady only once."""
        if self._looked and not self._later_rows and not self._later_loops:
            return
        c = Configuration(stage.t_stage, q, stage.v0, self._rest, stage.inputs)
        for row, term in self._later_rows:
            row[:] = 0.0
            term.add_residual(c, row)
        self._driver.calls.clear()
        for _, term in self._later_loops:
            term.add_linearization(c, self._into)
        for (k, _), call in zip(self._later_loops, self._driver.calls, strict=True):
            self._arguments[3 * k] = call.parameters
        if not self._looked:
            self._looked = True
            self._later_rows = [(row, term) for row, term in self._later_rows if not _steady(term)]
            self._later_loops = [(k, term) for k, term in self._later_loops if not _steady(term)]

    def _frames(self, stored: FrameState) -> tuple[Any, ...]:
        t = self._tables
        if not len(t.angles):
            return ()
        state = (stored.tangent, stored.director, stored.reference_twist)
        return (t.tails, t.heads, t.angles, t.joint_edges, t.joint_signs, *map(np.ascontiguousarray, state))


def _steady(term: BoundTerm) -> bool:
    """Whether a term is known to be the same at all times and under all inputs."""
    potential = term.potential
    return potential is not None and potential.steady


def weave(model: Model, pattern: SparsityPattern, at: Configuration) -> Woven | None:
    """The compiled step of a model on a pattern; None where it has none.

    Args:
        model: What is stepped.
        pattern: Its free DOFs.
        at: Some configuration.
    """
    tables = model.frames.tables
    if tables is None or model.driver.compiled(band_loops.pivoted) is None:
        return None
    found = weaving(model, pattern, at)
    if found.text is None:
        return None
    solve = model.driver.woven(found.text, found.below)
    return None if solve is None else Woven(model, pattern, tables, found, solve)


def _unsigned(indices: IntArray) -> NDArray[np.uint32]:
    return np.ascontiguousarray(indices, dtype=np.uint32)
