"""The energy account of a run: what came in, what went out, what is stored.

Stored energies are measured when asked for; work is summed over every step. The error is what the
time integrator made or lost: kinetic + elastic + gravitational - initial - work + dissipation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..arrays import FloatArray
from ..forces.load import DeadLoad
from ..kinematics.motion import moving_dofs
from ..kinematics.rod_frames import Frames, TrialFrames
from ..model.configuration import Configuration
from ..model.driven import BoundDriven
from ..model.model import Model
from ..model.saved import Arrays, Numbers
from ..model.state import State
from ..model.stencil import StencilEnergy
from ..model.term import BoundEnergy, BoundTerm, Term
from ..solve.system import System

# Energy from nowhere, in units of all energy that was given: no damping scheme comes near, and an
# unstable one passes it within a few steps.
_RUNAWAY = 100.0


@dataclass(frozen=True, slots=True)
class Roles:
    """Names of the terms by their place in the account."""

    elastic: tuple[str, ...]
    gravitational: tuple[str, ...]
    loads: tuple[str, ...]
    dissipative: tuple[str, ...]


class EnergyAccount:
    """Sums work over steps; measures stored energies on demand; implements :class:`.saved.Saved`."""

    columns = ("external_work", "actuation_work", "dissipation", "initial", "largest")

    def __init__(self, model: Model, roles: Roles, initial_velocity: FloatArray) -> None:
        self._model = model
        self._initial_velocity = initial_velocity
        self._size = float(np.ptp(model.dofs.positions(model.rest), axis=0).max())
        self._mass = float(model.mass.sum())
        self._roles = roles
        self._last: _Known | None = None
        self._bound: Mapping[str, BoundTerm] = {}
        self._elastic: Sequence[BoundEnergy] = ()
        self._gravitational: Sequence[BoundEnergy] = ()
        self.sums = dict.fromkeys(self.columns, 0.0)

    def bind(self, system: System, t: float) -> None:
        """Use the bound terms of a system from time ``t`` [s] on, with the DOFs that are held then."""
        model, terms = self._model, system.terms
        self._last = None
        self._moving = moving_dofs(model.motions, model.rest, self._initial_velocity, t)
        self._resisting = [term.bind(system.pattern, model.driver) for term in self._near_moving()]
        self._bound = {term.name: term for term in terms}
        # once per binding: a check against a protocol costs as much as a term
        energies = [term for term in terms if isinstance(term, BoundEnergy)]
        self._elastic = [t for t in energies if t.shares[0] in self._roles.elastic]
        self._gravitational = [t for t in energies if t.name in self._roles.gravitational]
        self._driven = [t for t in energies if isinstance(t, BoundDriven)]
        steady = {t.name for t in terms if isinstance(t, DeadLoad) and t.signal.constant}
        self._changing = [t for t in self._gravitational if t.name not in steady]

    def _near_moving(self) -> Iterator[Term]:
        """The terms as far as they act on moving DOFs."""
        mask = np.zeros(self._model.dofs.n, dtype=np.bool_)
        mask[self._moving] = True
        for term in self._model.terms if mask.any() else ():
            near = term.touching(mask) if isinstance(term, StencilEnergy) else term
            if not isinstance(near, StencilEnergy) or len(near.dofs):
                yield near

    def start(self, state: State) -> None:
        """Take the stored energy of ``state`` as the zero of the account."""
        self.sums["initial"] = 0.0
        self.sums["initial"] = self.measure(state)["error"]

    def advance(self, before: State, after: State) -> None:
        """Book the work of the step between two states."""
        start, end = self._see(before), self._see(after)
        if self._moving.size:
            self.sums["external_work"] += self._work_of_holds(start, end)
        if self._roles.loads or self._roles.dissipative:
            middle, moved = self._middle(before, after), after.q - before.q
            self.sums["external_work"] -= self._work(self._roles.loads, middle, moved)
            self.sums["dissipation"] += self._work(self._roles.dissipative, middle, moved)
        self.sums["actuation_work"] += self._change_in_time(self._driven, start, end)
        self.sums["external_work"] += self._change_in_time(self._changing, start, end)

    def measure(self, state: State) -> Mapping[str, float]:
        """All entries of the account at ``state`` [J]."""
        c = self._see(state).at(state.t)
        entries = {"kinetic": 0.5 * float(self._model.mass @ (state.v * state.v))}
        for term in self._elastic:
            entries |= zip(term.shares, term.energy(c).sum(axis=1).tolist(), strict=True)
        entries["elastic"] = sum(entries[name] for name in self._roles.elastic)
        entries["gravitational"] = sum(float(term.energy(c).sum()) for term in self._gravitational)
        entries["total"] = entries["kinetic"] + entries["elastic"] + entries["gravitational"]
        s = self.sums
        entries["external_work"] = s["external_work"] + s["actuation_work"]
        entries["dissipation"] = s["dissipation"]
        entries["error"] = entries["total"] - s["initial"] - entries["external_work"] + s["dissipation"]
        s["largest"] = max(s["largest"], entries["kinetic"] + abs(entries["elastic"]))
        return entries

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """The sums."""
        return self.sums

    def restore(self, arrays: Arrays, numbers: Numbers) -> EnergyAccount:
        """Go on from the sums that were saved."""
        self.sums = {name: float(numbers[name]) for name in self.columns}
        return self

    def growth(self, entries: Mapping[str, float]) -> float:
        """Energy that nothing gave, as a share of the largest kinetic and elastic energy of the run.

        Args:
            entries: Result of :meth:`measure`.
        """
        return entries["error"] / self.sums["largest"] if self.sums["largest"] and self._mass else 0.0

    def runs_away(self, entries: Mapping[str, float], seconds: float) -> bool:
        """Whether the robot holds far more energy than it was given: the integrator has blown up.

        Args:
            entries: Result of :meth:`measure`.
            seconds: Duration of the run [s]. Motions below a millionth of the robot's size in that
                time are round-off, not energy.
        """
        if not self._mass:
            return False  # statics rests in a balance that Newton's method has checked
        speed = 1e-6 * self._size / seconds
        given = abs(entries["external_work"]) + abs(entries["dissipation"]) + abs(self.sums["initial"])
        given += abs(entries["gravitational"]) + self._mass * speed**2
        return entries["error"] > _RUNAWAY * given

    def _work_of_holds(self, before: _Known, after: _Known) -> float:
        """Work of what holds and drives [J]: against all forces by the trapezoidal rule, and on masses.

        Mean forces, not forces of the mean state: there, edges that turn are shorter.
        """
        moving = self._moving
        path = after.state.q[moving] - before.state.q[moving]
        squares = after.state.v[moving] ** 2 - before.state.v[moving] ** 2
        work = 0.5 * float(self._model.mass[moving] @ squares)
        if path.any():
            work += 0.5 * float((self._resistance(before) + self._resistance(after)) @ path)
        return work

    def _resistance(self, known: _Known) -> FloatArray:
        """Residual on the moving DOFs."""
        if known.resistance is None:
            r = np.zeros_like(known.state.q)
            c = known.at(known.state.t)
            for term in self._resisting:
                term.add_residual(c, r)
            known.resistance = r[self._moving]
        return known.resistance

    def _middle(self, before: State, after: State) -> Configuration:
        """The mean state of a step, where work is measured with second-order accuracy."""
        q = 0.5 * (before.q + after.q)
        # pseudo-time has no speed
        v = (after.q - before.q) / (after.t - before.t) if self._mass else np.zeros_like(q)
        return Configuration(0.5 * (before.t + after.t), q, v, self._model.frames.transport(before.frames, q))

    def _work(self, names: tuple[str, ...], c: Configuration, moved: FloatArray) -> float:
        """Residual of the named terms times displacement [J]: the work done against them."""
        r = np.zeros_like(moved)
        for name in names:
            self._bound[name].add_residual(c, r)
        return float(r @ moved)

    def _change_in_time(self, terms: Sequence[BoundEnergy], before: _Known, after: _Known) -> float:
        """Change of energies by time alone [J], the mean of that at both shapes."""
        if not terms:
            return 0.0
        late, early = before.at(after.state.t), after.at(before.state.t)
        stored = self._stored(terms, after) - self._stored(terms, before)
        crossed = sum(float(term.energy(late).sum()) for term in terms)
        crossed -= sum(float(term.energy(early).sum()) for term in terms)
        return 0.5 * (crossed + stored)

    def _stored(self, terms: Sequence[BoundEnergy], known: _Known) -> float:
        """Energy of terms at their own time [J]."""
        total = 0.0
        for term in terms:
            if term.name not in known.energies:
                known.energies[term.name] = float(term.energy(known.at(known.state.t)).sum())
            total += known.energies[term.name]
        return total

    def _see(self, state: State) -> _Known:
        """What is known of a state; a step begins at the end of the last one."""
        if self._last is None or self._last.state is not state:
            self._last = _Known(state, self._model.frames)
        return self._last


@dataclass
class _Known:
    """A state, and what has been computed of it."""

    state: State
    frames: Frames
    resistance: FloatArray | None = None
    energies: dict[str, float] = field(default_factory=dict)

    @cached_property
    def transported(self) -> TrialFrames:
        return self.frames.transport(self.state.frames, self.state.q)

    def at(self, t: float) -> Configuration:
        return Configuration(t, self.state.q, self.state.v, self.transported)
