"""The energy account of a run: what came in, what went out, what is stored.

Stored energies are measured when asked for; work is summed over every step. The error is what the
time integrator made or lost: kinetic + elastic + gravitational - initial - work + dissipation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..forces.load import DeadLoad
from ..model.configuration import Configuration
from ..model.driven import BoundDriven
from ..model.frames import NoFrames
from ..model.model import Model
from ..model.motion import moving_dofs
from ..model.state import State
from ..model.term import BoundEnergy, BoundTerm

_UNFRAMED = NoFrames()


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
    """Sums work over steps; measures stored energies on demand."""

    columns = ("external_work", "actuation_work", "dissipation", "initial")

    def __init__(self, model: Model, roles: Roles, initial_velocity: FloatArray) -> None:
        self._model = model
        self._initial_velocity = initial_velocity
        self._size = float(np.ptp(model.dofs.positions(model.rest), axis=0).max())
        self._mass = float(model.mass.sum())
        self._roles = roles
        self._bound: Mapping[str, BoundTerm] = {}
        self._elastic: Sequence[BoundEnergy] = ()
        self._gravitational: Sequence[BoundEnergy] = ()
        self.sums = dict.fromkeys(self.columns, 0.0)

    def bind(self, terms: Sequence[BoundTerm], t: float) -> None:
        """Use these bound terms from time ``t`` [s] on, with the DOFs that are held then."""
        model = self._model
        self._moving = moving_dofs(model.motions, model.rest, self._initial_velocity, t)
        self._bound = {term.name: term for term in terms}
        # once per binding: a check against a protocol costs as much as a term
        energies = [term for term in terms if isinstance(term, BoundEnergy)]
        self._elastic = [t for t in energies if t.shares[0] in self._roles.elastic]
        self._gravitational = [t for t in energies if t.name in self._roles.gravitational]
        self._driven = [t for t in terms if isinstance(t, BoundDriven)]
        steady = {t.name for t in terms if isinstance(t, DeadLoad) and t.law.constant}
        self._changing = [t for t in self._gravitational if t.name not in steady]

    def start(self, state: State) -> None:
        """Take the stored energy of ``state`` as the zero of the account."""
        self.sums["initial"] = 0.0
        self.sums["initial"] = self.measure(state)["error"]

    def advance(self, before: State, after: State) -> None:
        """Book the work of the step between two states."""
        if self._moving.size:
            self.sums["external_work"] += self._work_of_holds(before, after)
        if self._roles.loads or self._roles.dissipative:
            middle, moved = self._middle(before, after), after.q - before.q
            self.sums["external_work"] -= self._work(self._roles.loads, middle, moved)
            self.sums["dissipation"] += self._work(self._roles.dissipative, middle, moved)
        self._book_drives(before, after)
        self._book_gravity_change(before, after)

    def measure(self, state: State) -> Mapping[str, float]:
        """All entries of the account at ``state`` [J]."""
        c = self._at(state, state.t)
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
        return entries

    def runs_away(self, entries: Mapping[str, float], seconds: float) -> bool:
        """Whether the robot holds far more energy than it was given: the integrator has blown up.

        Args:
            entries: Result of :meth:`measure`.
            seconds: Duration of the run [s]. Motions below a millionth of the robot's size in that
                time are round-off, not energy.
        """
        speed = 1e-6 * self._size / seconds
        given = abs(entries["external_work"]) + abs(entries["dissipation"]) + abs(self.sums["initial"])
        given += abs(entries["gravitational"]) + self._mass * speed**2
        return entries["error"] > _RUNAWAY * given

    def _work_of_holds(self, before: State, after: State) -> float:
        """Work of what holds and drives [J]: against all forces by the trapezoidal rule, and on masses.

        Mean forces, not forces of the mean state: there, edges that turn are shorter.
        """
        moving = self._moving
        path = after.q[moving] - before.q[moving]
        squares = after.v[moving] ** 2 - before.v[moving] ** 2
        work = 0.5 * float(self._model.mass[moving] @ squares)
        if path.any():
            r = np.zeros_like(after.q)
            for state in (before, after):
                c = self._at(state, state.t)
                for term in self._bound.values():
                    term.add_residual(c, r)
            work += 0.5 * float(r[moving] @ path)
        return work

    def _middle(self, before: State, after: State) -> Configuration:
        """The mean state of a step, where work is measured with second-order accuracy."""
        q = 0.5 * (before.q + after.q)
        v = (after.q - before.q) / (after.t - before.t)
        return Configuration(0.5 * (before.t + after.t), q, v, self._model.frames.transport(before.frames, q))

    def _work(self, names: tuple[str, ...], c: Configuration, moved: FloatArray) -> float:
        """Residual of the named terms times displacement [J]: the work done against them."""
        r = np.zeros_like(moved)
        for name in names:
            self._bound[name].add_residual(c, r)
        return float(r @ moved)

    def _book_drives(self, before: State, after: State) -> None:
        """Work of actuators: change of elastic energy by natural strain at fixed shape."""
        for term in self._driven:
            change = 0.0
            for state in (before, after):
                late, early = self._at(state, after.t), self._at(state, before.t)
                change += 0.5 * float(term.energy(late).sum() - term.energy(early).sum())
            self.sums["actuation_work"] += change

    def _book_gravity_change(self, before: State, after: State) -> None:
        """Work of a gravity that changes in time: change of potential at fixed position."""
        for term in self._changing:
            change = 0.0
            for state in (before, after):
                # weight acts on positions: frames need not be transported
                frames = _UNFRAMED.transport(state.frames, state.q)
                late, early = (Configuration(t, state.q, state.v, frames) for t in (after.t, before.t))
                change += 0.5 * float(term.energy(late).sum() - term.energy(early).sum())
            self.sums["external_work"] += change

    def _at(self, state: State, t: float) -> Configuration:
        return Configuration(t, state.q, state.v, self._model.frames.transport(state.frames, state.q))
