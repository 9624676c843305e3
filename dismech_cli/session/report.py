"""What a Python user gets from a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compose.compose import Composition
from ..errors import ExpectationError, SolverError, UnfinishedError
from ..frozen import frozen
from ..model.state import State
from ..output.frame import Frame
from ..run.loop import Outcome
from .exit_codes import Exit
from .verdicts import Verdict


@frozen
class Series:
    """A number over time.

    Attributes:
        t: Times [s], shape (K,).
        values: Values in SI units, shape (K,).
    """

    t: FloatArray
    values: FloatArray


@frozen(kw_only=True)
class Report:
    """A run, in memory.

    Attributes:
        exit: How it ended, as the exit code of the program: ``DONE``, ``SOLVER``, ``EXPECTATION``, or
            ``INTERRUPTED`` by a limit of wall time.
        message: Empty if all is well.
        verdicts: One per expectation, if the run came to its end.
        frames: All frames.
        scalars: Columns of ``scalars.csv`` over the frames, ``t`` first, each of shape (F,).
        probes: Those columns that are ``output.probes``.
        watched: The probe of each expectation after every step, by the name of the expectation.
        warnings: What is doubtful in the scenario, the plan and the result, a line or more each.
        seconds: Wall time by phase [s].
        run_dir: The run directory, or None.
        outcome: End of the run in full: counters, doubts, last state.
        composition: What was composed from the scenario: simulation, plan, bodies.
    """

    exit: Exit
    message: str
    verdicts: tuple[Verdict, ...]
    frames: tuple[Frame, ...]
    scalars: Mapping[str, FloatArray]
    probes: Mapping[str, FloatArray]
    watched: Mapping[str, Series]
    warnings: tuple[str, ...]
    seconds: Mapping[str, float]
    run_dir: Path | None
    outcome: Outcome
    composition: Composition

    @property
    def state(self) -> State:
        """The last accepted state; where a run fails, frames may end before it."""
        return self.outcome.state

    @property
    def positions(self) -> FloatArray:
        """Node positions in the last accepted state [m], shape (N, 3)."""
        dofs = self.composition.simulation.model.dofs
        return dofs.space_positions(self.state.q)[: dofs.visible]

    @property
    def velocities(self) -> FloatArray:
        """Node velocities in the last accepted state [m/s], shape (N, 3)."""
        dofs = self.composition.simulation.model.dofs
        return dofs.embed(dofs.positions(self.state.v)[: dofs.visible])

    @property
    def nodes(self) -> Mapping[str, IntArray]:
        """Nodes of each body by its name: ``report.positions[report.nodes["arm"]]``."""
        return self.composition.geometry.body_nodes

    def raise_for_status(self) -> Self:
        """Raise unless the run did what was asked for.

        Returns:
            The report itself.

        Raises:
            SolverError: The solver gave up.
            ExpectationError: An expectation was missed.
            UnfinishedError: The run was stopped before its end.
        """
        match self.exit:
            case Exit.DONE:
                return self
            case Exit.SOLVER:
                raise SolverError(self.message)
            case Exit.EXPECTATION:
                raise ExpectationError("\n".join(str(v) for v in self.verdicts if not v.passed))
            case _:
                raise UnfinishedError(self.message)


def columns(frames: Sequence[Frame], names: Sequence[str]) -> dict[str, FloatArray]:
    """The scalar table of some frames by column, ``t`` first."""
    table = {name: np.array([frame.scalars[name] for frame in frames]) for name in names}
    return {"t": np.array([frame.t for frame in frames]), **table}
