"""What compiled steps are told, and what they give back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.rod_frames import FrameState
from ..model.term import BoundTerm


@frozen
class Rule:
    """When a stage is solved.

    Attributes:
        limit: Most factorisations.
        slow: Factorisations from which a solution is doubted.
        tolerance: Of the residual, see :class:`.problem.NewtonSettings`.
        extent: Size of the rest shape [m].
    """

    limit: int
    slow: int
    tolerance: float
    extent: float


@frozen
class Held:
    """Where DOFs are held, and which move on paths that are not the integrator's.

    Attributes:
        dofs: Those that are held, shape (K,).
        values: Theirs at the end of each stage, or once for all, shape (stages, K).
        led: Those and the massless ones.
    """

    dofs: IntArray
    values: FloatArray
    led: IntArray


@frozen
class Rows:
    """Where steps end: row by row, with a row for each stage after that of the start.

    Attributes:
        q: Positions and angles, shape (rows, n).
        v: Rates; likewise ``a`` second rates.
        a: See ``v``.
        tangents: Of edges with frames, shape (rows, 3, E); likewise ``directors``.
        directors: See ``tangents``.
        twists: Reference twists of joints, shape (rows, J).
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    tangents: FloatArray
    directors: FloatArray
    twists: FloatArray

    @classmethod
    def of(cls, count: int, q: FloatArray, frames: FrameState) -> Rows:
        """Room for stages, with frames at the start."""
        edges, joints = frames.tangent.shape[1], len(frames.reference_twist)
        carried, twists = np.empty((2, count + 1, 3, edges)), np.empty((count + 1, joints))
        if edges:
            carried[0, 0], carried[1, 0], twists[0] = frames.tangent, frames.director, frames.reference_twist
        places = np.empty((3, count + 1, len(q)))
        return cls(places[0], places[1], places[2], carried[0], carried[1], twists)

    @property
    def all(self) -> tuple[FloatArray, ...]:
        """In order."""
        return self.q, self.v, self.a, self.tangents, self.directors, self.twists

    def frames(self, row: int, start: FrameState) -> FrameState:
        """Frames at the end of a stage; those at the start where there are none."""
        if not self.tangents.shape[2]:
            return start
        return FrameState(self.tangents[row], self.directors[row], self.twists[row])


@frozen
class March:
    """Steps that were taken.

    Attributes:
        steps: How many; fewer than were asked for where the next takes more than these know.
        rows: Where their stages end.
        residuals: M a + r at the end of each, shape (steps, n): on held DOFs the force that holds them.
        reactions: Of that what terms do, shape (steps, K).
        auxiliaries: Inputs of kernels at the end of each, shape (steps, size).
        norms: Largest free residual of each [N].
        shares: Of the lead, that would have made the guess of each best.
        iterations: Factorisations of each stage.
    """

    steps: int
    rows: Rows
    residuals: FloatArray
    reactions: FloatArray
    auxiliaries: FloatArray
    norms: FloatArray
    shares: FloatArray
    iterations: IntArray


@dataclass(slots=True)
class Stacked:
    """The parameters of a loop, stage by stage.

    Attributes:
        term: Whose loop it is.
        tables: What the loop takes after the parameters.
        argument: Its place among the arguments of the compiled function.
        stacks: Room for each parameter, whose first axis is that of the stages.
    """

    term: BoundTerm
    tables: tuple[Any, ...]
    argument: int
    stacks: tuple[FloatArray, ...] = ()

    def put(
        self, parameters: Sequence[FloatArray | float], place: int, room: int, arguments: list[Any]
    ) -> None:
        """Write the parameters of a stage, in an argument with room for some stages."""
        if not self.stacks or len(self.stacks[0]) < room:
            self.stacks = tuple(np.empty((room, *np.shape(values))) for values in parameters)
            arguments[self.argument] = (*self.stacks, *self.tables)
        for stack, values in zip(self.stacks, parameters, strict=True):
            stack[place] = values
