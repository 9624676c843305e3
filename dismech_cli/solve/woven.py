"""Stages and steps solved in one compiled function, without Python between the iterations.

Such a step knows full steps of Newton's method alone, with tangents that need no second thought: where a
stage is not solved so, it says nothing, and the step is taken from its start by what can do more, and ends as
it would have ended.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.linearization import Linearization
from ..kinematics.rod_frames import EdgeTables, FrameState, TrialFrames
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from ..model.term import BoundTerm
from .marched import Held, March, Rows, Rule, Stacked
from .pattern import SparsityPattern
from .stage import Stage
from .stage_maps import StageMaps, stacked
from .weaving import Parts, Weaving, weaving

_EPS: Final = float(np.finfo(np.float64).eps)
_NO_MAPS: Final = np.empty((0, 1, 7, 6))
_NO_DOFS: Final = np.empty(0, dtype=np.int64)


@frozen
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
    """The compiled steps of a system."""

    def __init__(
        self,
        model: Model,
        pattern: SparsityPattern,
        tables: EdgeTables,
        woven: Weaving,
        march: Callable[..., Any],
    ) -> None:
        """Prepare what does not change from stage to stage; see :func:`weave`."""
        driver, parts = woven.driver, woven.parts
        self._march, self._driver = march, driver
        self._edges = (tables.tails, tables.heads, tables.angles, tables.joint_edges, tables.joint_signs)
        constant = [part.term for part in parts.all if part.block is None]
        self._rows, self._still = np.zeros((1, len(constant), model.dofs.n)), np.zeros(model.dofs.n)
        self._into = Linearization.of(model.dofs.n, 1)
        self._rest = TrialFrames(model.frames.rest(model.rest), np.empty(0))
        self._mass, self._split, self._length = model.mass, model.dofs.n_positions, model.length
        self._size = model.frames.size
        self._vectors = np.zeros((8, model.dofs.n))
        self._place(pattern, parts)
        # the rows and the loops' parameters that change from stage to stage
        self._later_rows = list(enumerate(constant))
        self._later_loops = [
            Stacked(term, tables, 3 * k)
            for k, (term, tables) in enumerate(
                (part.term, part.block.tables) for part in parts.all if part.block is not None
            )
        ]
        self._looked = False
        self._room = 1

    def _place(self, pattern: SparsityPattern, parts: Parts) -> None:
        general = not pattern.symmetric
        width, m = pattern.bandwidth, pattern.m
        rows, columns = pattern.rows, pattern.indices
        step = 3 * width + 1 if general else width + 1
        # the last, beyond the rows of zeros, takes what is fixed
        entries = (m + width) * step + 1
        places = np.append(rows * step + columns - rows + (width if general else 0), entries - 1)
        diagonal = _unsigned(places[pattern.diagonal])
        lower, upper = pattern.mirror() if general else (np.empty(0, dtype=np.int64),) * 2
        mirror = (_unsigned(places[lower]), _unsigned(places[upper]))
        self._band = (
            np.empty(entries),
            np.empty(entries if parts.damped else 0),
            np.empty(entries + 3 * (m + 2 * width)),
            np.empty(m, dtype=np.int64),
        )
        at_node = pattern.free < self._split
        self._sides = (pattern.free, at_node, diagonal, mirror)
        self._rounding = 2.0 * _EPS * sqrt(int(at_node.sum()))
        self._arguments: list[Any] = []
        for part in parts.all:
            if part.block is not None:
                indices = tuple(map(_unsigned, part.block.indices))
                slots = tuple(_unsigned(places[slots]) for slots in part.block.slots)
                self._arguments += (None, indices, slots)

    def solve(self, stage: Stage, stored: FrameState, guess: FloatArray, rule: Rule) -> Solved | None:
        """Solve a stage; None where that takes more than full steps.

        Args:
            stage: What is solved.
            stored: Frames at the start of the step.
            guess: First guess, prescribed values in place, shape (n,).
            rule: When it is solved.
        """
        self._look([stage.t_stage], guess, stage.inputs)
        w = stage.weights
        self._vectors[7], self._vectors[2:5] = guess, (stage.q0, stage.v0, stage.a0)
        numbers = np.array([[[w.q, w.v, w.a, 0.0, 0.0, 0.0]]])
        maps = (_NO_MAPS, numbers, np.zeros(1), np.zeros(1, dtype=np.int64))
        nothing = Held(_NO_DOFS, np.empty((1, 0)), _NO_DOFS)
        found = self._run(maps, 1, 0.0, nothing, Rows.of(1, guess, stored), rule)
        if not found.steps:
            return None
        frames = found.rows.frames(1, stored)
        return Solved(
            self._vectors[7].copy(),
            found.residuals[0],
            int(found.iterations[0]),
            float(found.norms[0]),
            frames,
        )

    def march(
        self,
        start: State,
        times: Sequence[float],
        steps: tuple[StageMaps, ...],
        share: float,
        held: Held,
        rule: Rule,
    ) -> March:
        """Take steps one after another, as far as these know the way.

        Args:
            start: Where the first begins.
            times: Where each begins [s].
            steps: Maps of each.
            share: Of the lead in the first guess.
            held: What is held.
            rule: When a stage is solved.
        """
        balances = [t + balance for t, maps in zip(times, steps, strict=True) for balance in maps.balance]
        self._look(balances, start.q, start.inputs)
        rows = Rows.of(len(balances), start.q, start.frames)
        rows.q[0], rows.v[0], rows.a[0] = start.q, start.v, start.a
        return self._run(stacked(steps), len(steps), share, held, rows, rule)

    def _run(
        self, maps: tuple[Any, ...], steps: int, share: float, held: Held, rows: Rows, rule: Rule
    ) -> March:
        """Call the compiled function."""
        n, stages = self._vectors.shape[1], maps[1].shape[1]
        out = March(
            steps,
            rows,
            np.empty((steps, n)),
            np.empty((steps, len(held.dofs))),
            np.empty((steps, self._size)),
            np.empty(steps),
            np.empty(steps),
            np.empty(steps * stages, dtype=np.int64),
        )
        done = self._march(
            steps,
            (rule.limit, rule.slow, self._split),
            (rule.tolerance, self._length, rule.extent, self._rounding),
            share,
            maps,
            self._vectors,
            (held.dofs, held.values),
            held.led,
            self._mass,
            self._rows,
            self._sides,
            self._band,
            self._edges,
            rows.all,
            (out.residuals, out.reactions, out.auxiliaries, out.norms, out.shares, out.iterations),
            *self._arguments,
        )
        return out if done == steps else replace(out, steps=done)

    def _look(self, times: Sequence[float], q: FloatArray, inputs: FloatArray) -> None:
        """Ask the terms for their constants and parameters at times [s]; what is steady only once.

        What is asked depends on nothing but times and inputs.
        """
        if self._looked and not self._later_rows and not self._later_loops:
            return
        if len(times) > self._room:
            self._room = len(times)
            self._rows = np.repeat(self._rows[:1], self._room, axis=0)
        for place, t in enumerate(times):
            c = Configuration(t, q, self._still, self._rest, inputs)
            for row, term in self._later_rows:
                self._rows[place, row] = 0.0
                term.add_residual(c, self._rows[place, row])
            self._driver.calls.clear()
            for one in self._later_loops:
                one.term.add_linearization(c, self._into)
            for one, call in zip(self._later_loops, self._driver.calls, strict=True):
                one.put(call.parameters, place, self._room, self._arguments)
        if not self._looked:
            self._looked = True
            self._later_rows = [(row, term) for row, term in self._later_rows if not _steady(term)]
            self._later_loops = [one for one in self._later_loops if not _steady(one.term)]


def _steady(term: BoundTerm) -> bool:
    """Whether a term is known to be the same at all times and under all inputs."""
    potential = term.potential
    return potential is not None and potential.steady


def weave(model: Model, pattern: SparsityPattern, at: Configuration) -> Woven | None:
    """The compiled steps of a model on a pattern; None where it has none.

    Args:
        model: What is stepped.
        pattern: Its free DOFs.
        at: Some configuration.
    """
    tables = model.frames.tables
    if tables is None:
        return None
    found = weaving(model, pattern, at)
    if found.text is None:
        return None
    march = model.driver.woven(found.text, found.below)
    return None if march is None else Woven(model, pattern, tables, found, march)


def _unsigned(indices: IntArray) -> NDArray[np.uint32]:
    return np.ascontiguousarray(indices, dtype=np.uint32)
