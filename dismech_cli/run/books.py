"""What is booked of a run as it goes on."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, fields

from ..model.saved import Saved
from ..model.state import State
from ..solve.plain import Steps
from ..solve.step import Stepper
from ..solve.step_result import StepResult
from .account import EnergyAccount
from .ambiguity import Ambiguity
from .framing import Framing
from .observe import Observer, Singular
from .simulation import Simulation
from .sink import Sink
from .symmetry import Symmetry
from .tally import Counters, Stopwatch
from .validity import Validity
from .watched import Watched


@dataclass(slots=True)
class Books:
    """All that a run remembers beside where it stands; each part saves itself.

    Attributes:
        counters: Steps and iterations so far.
        stopwatch: Wall time so far.
        account: Energies and work.
        watched: Probes read after every step.
        validity: What passed the limits of the models.
        symmetry: What nothing disturbs.
        ambiguity: Steps with more than one solution.
        framing: Frames written.
    """

    counters: Counters
    stopwatch: Stopwatch
    account: EnergyAccount
    watched: Watched
    validity: Validity
    symmetry: Symmetry
    ambiguity: Ambiguity
    framing: Framing

    @classmethod
    def of(
        cls,
        simulation: Simulation,
        stepper: Stepper,
        sink: Sink,
        singular: list[Singular],
        stopwatch: Stopwatch,
    ) -> Books:
        """Empty ones; ``singular`` is told where eigenvalues cannot be counted."""
        account = EnergyAccount(simulation.model, simulation.roles, simulation.start)
        account.bind(stepper.system, 0.0)
        observer = Observer(simulation, stepper, account, singular.append)
        watched, validity = Watched(simulation.watched), Validity(simulation.checks)
        return cls(
            counters=Counters(),
            stopwatch=stopwatch,
            account=account,
            watched=watched,
            validity=validity,
            symmetry=Symmetry(stepper),
            ambiguity=Ambiguity(),
            framing=Framing(
                simulation.frame_every, simulation.looks, observer, watched, validity, sink, stopwatch
            ),
        )

    def parts(self) -> dict[str, Saved]:
        """All of them, by name."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def take(self, parts: Mapping[str, Saved]) -> None:
        """Go on with parts that were restored."""
        for one in fields(self):
            setattr(self, one.name, parts[one.name])

    def step(self, before: State, result: StepResult, t_end: float) -> None:
        """Book a step that was taken, of a run up to ``t_end`` [s]."""
        tick = time.perf_counter()
        self.account.advance(before, result)
        self.counters.steps += 1
        if result.ambiguous:
            self.ambiguity.taken(result.state.t)
        self.symmetry.look(result.state, t_end)
        self.stopwatch.book("observe", tick)

    def leap(self, before: State, steps: Steps, result: StepResult, t_end: float, *, balanced: bool) -> None:
        """Book many steps from a state to the last result, of a run up to ``t_end`` [s].

        Args:
            before: Where they begin.
            steps: The steps.
            result: The last one.
            t_end: End of the run [s].
            balanced: Whether they end in balance.
        """
        tick = time.perf_counter()
        self.counters.steps += steps.count
        self.counters.iterations += steps.iterations
        for step, t in enumerate(steps.times[1:]):
            if self.symmetry.due(t):
                self.symmetry.look(steps.kept(step), t_end)
        if self.account.at_ease(balanced=balanced) and not self.framing.watches:
            self.account.leap(before, steps, result)
        else:
            for step in range(steps.count - 1):
                one = steps.result(step)
                self.account.advance(before, one)
                self.framing.read(one)
                before = one.state
            self.account.advance(before, result)
        self.stopwatch.book("observe", tick)

    @property
    def counts(self) -> dict[str, int]:
        """Steps, iterations, failures and frames."""
        count = self.counters
        return {
            "steps": count.steps,
            "iterations": count.iterations,
            "cuts": count.cuts,
            "refused": count.refused,
            "frames": self.framing.frames,
        }
