"""The course of one run: where it stands, and what is booked as it goes on."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from ..model.saved import Arrays, Numbers, Saved, restore_all, save_all
from ..model.state import State
from ..solve.status import Status
from ..solve.step import Stepper, StepResult
from .account import EnergyAccount
from .ambiguity import Ambiguity
from .framing import Framing
from .observables.snapshot import Snapshot
from .observe import Observer, Singular
from .simulation import Simulation
from .sink import Progress, Sink
from .step_control import StepControl
from .symmetry import Symmetry
from .tally import Counters, Stopwatch
from .validity import Validity
from .watched import Watched

_PARTS = (
    "state",
    "control",
    "counters",
    "stopwatch",
    "account",
    "watched",
    "validity",
    "symmetry",
    "ambiguity",
    "framing",
)


@dataclass(slots=True)
class Course:
    """One run under way.

    Attributes:
        simulation: What is run.
        stepper: Takes its steps.
        sink: Where results go.
        state: Where it stands.
        control: How far the next step goes.
        counters: Steps and iterations so far.
        stopwatch: Wall time so far.
        account: Energies and work.
        watched: Probes read after every step.
        validity: What passed the limits of the models.
        symmetry: What nothing disturbs.
        ambiguity: Steps with more than one solution.
        framing: Frames written.
        singular: Where eigenvalues could not be counted: the first state, if any.
    """

    simulation: Simulation
    stepper: Stepper
    sink: Sink
    state: State
    control: StepControl
    counters: Counters
    stopwatch: Stopwatch
    account: EnergyAccount
    watched: Watched
    validity: Validity
    symmetry: Symmetry
    ambiguity: Ambiguity
    framing: Framing
    singular: list[Singular]

    @classmethod
    def of(cls, simulation: Simulation, sink: Sink) -> Course:
        """Stand before the start of a run."""
        stopwatch, tick = Stopwatch(), time.perf_counter()
        stepper = Stepper(
            simulation.model,
            simulation.integrator,
            simulation.newton,
            simulation.linear_solver,
            simulation.advance,
        )
        account = EnergyAccount(simulation.model, simulation.roles, simulation.start)
        account.bind(stepper.system, 0.0)
        singular: list[Singular] = []
        observer = Observer(simulation, stepper, account, singular.append)
        watched = Watched(simulation.watched)
        stopwatch.book("bind", tick)
        validity = Validity(simulation.checks)
        return cls(
            simulation=simulation,
            stepper=stepper,
            sink=sink,
            state=simulation.start,
            control=simulation.control,
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
            singular=singular,
        )

    def parts(self) -> dict[str, Saved]:
        """All that the run remembers from step to step: each saves itself."""
        return {name: getattr(self, name) for name in _PARTS}

    @property
    def counts(self) -> dict[str, int]:
        """Steps, iterations, cuts, frames, analyses; with contact rebuilds of its places."""
        count, contact = self.counters, self.simulation.touched is not None
        return {
            "steps": count.steps,
            "iterations": count.iterations,
            "cuts": count.cuts,
            "refused": count.refused,
            "frames": self.framing.frames,
            "analyses": self.stepper.analyses,
            **({"rebuilds": count.rebuilds} if contact else {}),
        }

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time of this process by phase [s]; what contact takes in steps is a phase of its own."""
        return self.stopwatch.seconds

    def begin(self) -> Snapshot | None:
        """Start: the energy at rest is the zero of the account.

        Returns:
            What the first frame shows.
        """
        tick = time.perf_counter()
        self._prepare()
        self.account.start(self.state)
        self.stopwatch.book("bind", tick)
        nothing = np.zeros_like(self.state.q)
        result = StepResult(self.state, Status.CONVERGED, 0, 0.0, nothing, -1)
        return self._show(self.state, result, 0.0)

    def resume(self, arrays: Arrays, numbers: Numbers) -> None:
        """Start from a checkpoint."""
        for name, part in restore_all(self.parts(), arrays, numbers).items():
            setattr(self, name, part)
        tick = time.perf_counter()
        self._prepare()
        self.stopwatch.book("bind", tick)

    def checkpoint(self) -> None:
        """Save all parts."""
        tick = time.perf_counter()
        arrays, numbers = save_all(self.parts())
        structure = {f"structure.{name}": array for name, array in self.simulation.structure.items()}
        self.sink.checkpoint(arrays | structure, numbers)
        self.stopwatch.book("write", tick)

    def step(self) -> StepResult:
        """Try to reach the control's target; a step that fails leaves the run where it is.

        Raises:
            LawError: Something that the step follows has no value there.
            ControlError: A controller fails.
        """
        target, tick = self.control.target, time.perf_counter()
        touching = self.stepper.changing_seconds
        self._act(target)
        self._prepare()
        step = self.stepper.step if self.control.exhausted else self.stepper.attempt
        result = step(self.state, target - self.state.t)
        self.stopwatch.book("solve", tick)
        if self.simulation.touched is not None:
            self.stopwatch.move(self.stepper.changing_seconds - touching, "solve", "contact")
        self.counters.iterations += result.iterations
        if result.status is not Status.CONVERGED:
            return result
        if (lost := _lost(result.state)) >= 0:
            return replace(result, state=self.state, status=Status.NOT_FINITE, worst=lost)
        if result.state.t == target or result.arrived:
            return result
        # the integrator adds dt, which may round
        return replace(result, state=replace(result.state, t=target))

    def cut(self, result: StepResult) -> None:
        """Shorten the step that failed."""
        t = self.state.t
        self.sink.event("step_cut", t, dt=self.control.target - t, status=result.status.name)
        self.control = self.control.failed()
        self.counters.cuts += 1

    def refuse(self, result: StepResult, shorter: StepControl) -> None:
        """Take a step again that was not accurate, shortened."""
        t = self.state.t
        self.sink.event("step_refused", t, dt=result.state.t - t)
        self.control = shorter
        self.counters.refused += 1

    def accept(self, result: StepResult) -> Snapshot | None:
        """Book a step that reached its target, and go on from there.

        Returns:
            What the frame shows, if one was due.
        """
        before, dt = self.state, result.state.t - self.state.t
        tick = time.perf_counter()
        self.account.advance(before, result.state, result.put_in, result.trail[1:-1])
        tick = self.stopwatch.book("observe", tick)
        self._tell_contact(result.state)
        if result.ambiguous:
            self.ambiguity.taken(result.state.t)
            self.sink.event("ambiguous_step", result.state.t, dt=dt)
        self.state = result.state
        self.control = self.control.accepted(result)
        self.counters.steps += 1
        tick = time.perf_counter()
        self.symmetry.look(self.state, self.control.t_end)
        self.stopwatch.book("observe", tick)
        return self._show(before, result, dt)

    def _tell_contact(self, after: State) -> None:
        """Events of contact in a step."""
        touched = self.simulation.touched
        if touched is None:
            return
        if (rebuilt := touched.rebuilt(self.state, after)) is not None:
            self.counters.rebuilds += 1
            self.sink.event("contact_rebuilt", after.t, **rebuilt)
        if (found := touched.too_deep(self.state, after)) is not None:
            near = self.simulation.places[found.node]
            self.sink.event("penetration", after.t, between=found.pair, share=found.share, near=near)

    def report(self, dt: float) -> None:
        """Tell where the run stands after a step of ``dt`` [s]."""
        count = self.counters
        self.sink.progress(Progress(self.state.t, self.control.t_end, dt, count.steps, count.iterations))

    def _show(self, before: State, result: StepResult, dt: float) -> Snapshot | None:
        return self.framing.see(before, result, dt, self.counters.iterations, last=self.control.done)

    def _act(self, target: float) -> None:
        """Let controllers put in what they do for a step to a time [s]."""
        acted = self.simulation.controls.act(self.state, target)
        if acted is not self.state:
            self.account.put_in(self.state, acted)
            self.state = acted

    def _prepare(self) -> None:
        """Make ready for a step: the account follows the stepper to other free DOFs."""
        system = self.stepper.system
        self.state = self.stepper.prepare(self.state)
        if self.stepper.system is not system:
            self.account.bind(self.stepper.system, self.state.t)


def _lost(state: State) -> int:
    """A DOF that is at no finite place or has no finite speed; -1 if there is none."""
    if isfinite(state.q.dot(state.v)):
        return -1
    nowhere = ~np.isfinite(state.q + state.v)
    return int(np.argmax(nowhere)) if nowhere.any() else -1
