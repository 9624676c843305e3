"""Numbers read from a run, and how they change with its states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ...model.alike import alike
from ...model.model import Model
from ...model.state import State
from ...run.account import EnergyAccount
from ...run.observables.probes import Probe
from ...run.observables.reduce import reduce_series
from ...run.observables.snapshot import Snapshot
from ...run.observe import Observer
from ...run.simulation import Simulation
from ...solve.adjoint import Owed
from ...solve.anew import Anew
from ...solve.neighbours import CENTRAL, Variation
from ...solve.step import Stepper
from ...solve.tape import TapedStep
from ...solve.trials import at
from .nearby import Nearby

Probes = Sequence[Probe]

# Units of what is read from the state alone: at one state it differs between scenes by its places only.
_OF_STATE = ("m", "m/s", "rad")
# Largest displacement of a state to see how a number changes, of an edge; largest turn [rad]. Where things
# touch it is small against how deep they are in each other.
_SMALL, _SMALLER = 1e-3, 1e-6
# Shares of these that are tried, and the share by which two differences may be apart: a fourth-order one is
# off by about the square of that.
_SHORTER, _BENT = (1.0, 1e-2, 1e-4), 1e-5


@frozen
class Reduced:
    """A probe and what becomes of its course over time.

    Attributes:
        name: Its name in the scenario.
        probe: The probe.
        how: Key of the reductions.
        at: Time of measurement in place of it [s].
        after: Time before which nothing counts [s].
    """

    name: str
    probe: Probe
    how: str = "last"
    at: float | None = None
    after: float | None = None

    @property
    def of_end(self) -> bool:
        """Whether the last state alone counts."""
        return self.how == "last" and self.at is None

    @property
    def smooth(self) -> bool:
        """Whether it has no kinks."""
        return self.how not in ("min", "max", "span", "period")

    def __call__(self, times: FloatArray, values: FloatArray) -> float:
        """The number of a course."""
        return reduce_series(times, values, self.how, at=self.at, after=self.after)

    def slope(self, times: FloatArray, values: FloatArray, change: FloatArray) -> float:
        """Change of the number with that of the course, all of shape (K,)."""
        size = float(np.abs(change).max(initial=0.0))
        if size == 0.0:
            return 0.0
        step = 1e-4 * (float(np.abs(values).max()) or 1.0) / size
        numbers = [np.asarray(self(times, values + k * step * change)) for k in CENTRAL.offsets]
        return float(CENTRAL(numbers, step))


class Eye:
    """Reads probes at states of one simulation, any of them and in any order.

    Attributes:
        length: Characteristic edge length [m].
        edges: Edges whose frames are carried.
    """

    def __init__(self, simulation: Simulation) -> None:
        """Bind nothing yet: most probes read the state alone."""
        self._simulation, self._model = simulation, simulation.model
        self.length = simulation.model.length
        self.edges = simulation.model.frames.turning

    @cached_property
    def _observer(self) -> Observer:
        """What probes of energies, strains and contact ask, bound when one does."""
        simulation = self._simulation
        stepper = Stepper(
            simulation.model, simulation.integrator, simulation.newton, simulation.linear_solver
        )
        account = EnergyAccount(simulation.model, simulation.roles, simulation.start)
        account.bind(stepper.system, 0.0)
        return Observer(simulation, stepper, account, lambda found: None)

    @cached_property
    def _anew(self) -> Anew:
        """What touches, at any state."""
        return Anew(self._model.changing, self._model.driver)

    def read(self, probe: Probe, state: State, residual: FloatArray) -> float:
        """A probe at a state, with the residual of the stage that led there (n,)."""
        return probe(
            Snapshot(
                self._model,
                state,
                residual,
                lambda: self._observer.snapshot(state, residual).energies,
                lambda: self._observer.snapshot(state, residual).negative_eigenvalues,
                lambda name: self._observer.snapshot(state, residual).stencil_energies(name),
                lambda name: self._observer.snapshot(state, residual).natural(name),
                lambda: self._anew.touch(at(self._model, state)),
            )
        )

    def moved(self, state: State, d: Variation, column: int, step: float) -> State:
        """A state by a step on in the direction of one parameter; its frames stay where they are stored."""
        return d.moved(state, column, step)

    def turned(self, state: State, d: Variation, column: int, step: float) -> State:
        """The same with frames that turn with it."""
        return turned(self._model, state, d, column, step)

    def small(self, d: Variation, column: int) -> float:
        """A step in the direction of a parameter that moves a state by little; 0 where nothing moves."""
        n = self._model.dofs.n_positions
        moved = float(np.abs(d.q[:n, column]).max(initial=0.0)) / self._model.length
        turned = float(np.abs(d.q[n:, column]).max(initial=0.0))
        fastest = max(moved, turned)
        if fastest > 0.0:
            return (_SMALLER if self._model.changing else _SMALL) / fastest
        rest = max(float(np.abs(x[:, column]).max(initial=0.0)) for x in (d.v, d.residual, d.inputs))
        return 1.0 / rest if rest > 0.0 else 0.0


class Readings:
    """One probe along a taped run, with its derivatives to parameters."""

    def __init__(
        self, simulation: Simulation, probe: Probe, near: Sequence[Nearby], near_probes: Sequence[Probes]
    ) -> None:
        """Prepare to look.

        Args:
            simulation: What was run.
            probe: What is read.
            near: Neighbours of each parameter.
            near_probes: The same probe as each of them has it: its places may move with the parameter.
        """
        self._eye, self._probe = Eye(simulation), probe
        # energies, and strains that sensors read, are read from frames
        self._move = self._eye.moved if probe.unit in (*_OF_STATE, "N") else self._eye.turned
        self._near = [one.neighbours for one in near]
        self._others = [
            [(Eye(other), there) for other, there in zip(one.simulations, probes, strict=True)]
            if probe.unit not in _OF_STATE or not all(alike(probe, there) for there in probes)
            else []
            for one, probes in zip(near, near_probes, strict=True)
        ]

    @property
    def of_forces(self) -> bool:
        """Whether it is read from the residual."""
        return self._probe.unit == "N"

    def value(self, state: State, residual: FloatArray) -> float:
        """The number at a state, with the residual that led there (n,)."""
        return self._eye.read(self._probe, state, residual)

    def slopes(self, state: State, residual: FloatArray, d: Variation) -> FloatArray:
        """Its derivatives, shape (P,): by the scene at a fixed state, and by the state."""
        return np.array(
            [
                self._by_scene(k, state, residual) + self._by_state(k, state, residual, d)
                for k in range(len(self._near))
            ]
        )

    def _by_scene(self, k: int, state: State, residual: FloatArray) -> float:
        if not self._others[k] or not self._near[k].counts(state.law_time):
            return 0.0
        seen = [np.asarray(eye.read(probe, state, residual)) for eye, probe in self._others[k]]
        return float(self._near[k].slope(seen))

    def _by_state(self, k: int, state: State, residual: FloatArray, d: Variation) -> float:
        step = self._eye.small(d, k)
        if step == 0.0:
            return 0.0

        def read(change: float) -> float:
            moved = self._move(state, d, k, change)
            return self._eye.read(self._probe, moved, residual + change * d.residual[:, k])

        return _slope(read, step)

    def owed(self, state: State, residual: FloatArray) -> Owed:
        """Derivative to the state itself, one number after the other; of probes of shape and velocity."""
        n, turns = len(state.q), tuple(np.zeros(len(e.angles)) for e in self._eye.edges)
        fastest = float(np.abs(state.v).max(initial=0.0)) or 1.0
        by_q = _gradient(
            lambda q: self.value(replace(state, q=q), residual), state.q, _SMALL * self._eye.length
        )
        by_v = _gradient(lambda v: self.value(replace(state, v=v), residual), state.v, _SMALL * fastest)
        return Owed(by_q, by_v, np.zeros(n), turns)

    def by_scene(self, state: State, residual: FloatArray) -> FloatArray:
        """Derivatives to the parameters at a fixed state, shape (P,)."""
        return np.array([self._by_scene(k, state, residual) for k in range(len(self._near))])


def turned(model: Model, state: State, d: Variation, column: int, step: float) -> State:
    """A state by a step on in the direction of one parameter, its frames too."""
    moved = d.moved(state, column, step)
    turns = [step * turn[:, column] for turn in d.turns]
    return replace(moved, frames=model.frames.turned(state.frames, moved.q, turns))


def _gradient(read: Callable[[FloatArray], float], x: FloatArray, step: float) -> FloatArray:
    """Derivatives of a number to each of the numbers (n,) that it is read from, mostly few of them."""
    found, here = np.zeros_like(x), read(x)
    # no two of these displacements add up to nothing, whatever the weights of what is read
    moved = step * (0.5 + np.modf(np.arange(1, len(x) + 1) * 0.6180339887498949)[0])
    parts = [(0, len(x))]
    while parts:
        first, end = parts.pop()
        there = x.copy()
        there[first:end] += moved[first:end]
        if read(there) == here:
            continue
        if end - first > 1:
            middle = (first + end) // 2
            parts += [(first, middle), (middle, end)]
            continue

        def read_at(change: float, place: int = first) -> float:
            there = x.copy()
            there[place] += change
            return read(there)

        found[first] = _slope(read_at, step)
    return found


def _slope(read: Callable[[float], float], step: float) -> float:
    """Derivative of a number that is read.

    Steps are shortened where it bends within them, as distances do that are next to nothing.
    """
    best, least = 0.0, np.inf
    for shorter in _SHORTER:
        h = shorter * step
        values = [np.asarray(read(offset * h)) for offset in CENTRAL.offsets]
        one, other = (values[0] - values[1]) / (2.0 * h), (values[2] - values[3]) / (4.0 * h)
        gap = float(abs(one - other))
        if gap < least:
            best, least = float(CENTRAL(values, h)), gap
        if gap <= _BENT * float(abs(one)):
            break
    return best


def states(start: State, steps: Sequence[TapedStep]) -> list[tuple[State, FloatArray]]:
    """Every accepted state of a run with the residual that led to it."""
    return [(start, np.zeros_like(start.q)), *((one.result.state, one.result.residual) for one in steps)]
