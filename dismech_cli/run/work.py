"""Work done during a step [J], between the states at its ends."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.rod_frames import Frames, FramesAt, FrameState, TrialFrames
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from ..model.term import BoundEnergy, BoundTerm, Term
from ..solve.plain import Steps
from ..solve.system import System
from .roles import Roles

# Half of the difference quotient of a power, in steps.
_QUOTIENT = 1e-3


@dataclass
class Carried:
    """Frames at a point, carried there when a term first asks: forces on nodes alone never do.

    Attributes:
        frames: Kinematics of frames.
        stored: Where they come from.
        q: Where they go to, shape (n,).
    """

    frames: Frames
    stored: FrameState
    q: FloatArray

    @cached_property
    def _there(self) -> TrialFrames:
        return self.frames.transport(self.stored, self.q)

    @property
    def state(self) -> FrameState:
        """What an accepted step would store."""
        return self._there.state

    @property
    def auxiliary(self) -> FloatArray:
        """Inputs of kernels, shape (size,)."""
        return self._there.auxiliary


@dataclass
class Known:
    """A state, and what has been computed of it.

    Attributes:
        state: The state.
        frames: Kinematics of frames.
        resistance: What terms do to the moving DOFs.
        auxiliary: Inputs of kernels.
        moving: Values of the moving DOFs, and the squares of their rates.
        energies: Of terms at their own time [J], by name.
    """

    state: State
    frames: Frames
    resistance: FloatArray | None = None
    auxiliary: FloatArray | None = None
    moving: tuple[FloatArray, FloatArray] | None = None
    energies: dict[str, float] = field(default_factory=dict)

    @cached_property
    def carried(self) -> FramesAt:
        """Frames at the state."""
        if self.auxiliary is not None:
            return TrialFrames(self.state.frames, self.auxiliary)
        return Carried(self.frames, self.state.frames, self.state.q)

    def at(self, other: State) -> Configuration:
        """Its shape at the time and under the inputs of another state."""
        return Configuration(other.law_time, self.state.q, self.state.v, self.carried, other.inputs)


@frozen
class Part:
    """A part of a step.

    Attributes:
        mean: Its mean state.
        moved: The way gone, shape (n,).
    """

    mean: Configuration
    moved: FloatArray


class Work:
    """Measures work with the bound terms of one system."""

    def __init__(self, model: Model, roles: Roles, system: System, moving: IntArray) -> None:
        """Find the terms.

        Args:
            model: The semi-discrete system.
            roles: Place of its terms in the account.
            system: The model bound to the DOFs that are free.
            moving: Held DOFs that move.
        """
        self._model = model
        self._moving = moving
        self._mass = model.mass[moving]
        self._moves = bool(model.mass.any())
        self._resisting: list[BoundTerm] = []
        self._damping: list[BoundTerm] = []
        if moving.size:
            near = {t.name: t.bind(system.pattern, model.driver) for t in _near(model, roles, moving)}
            self._damping = [near.pop(name) for name in roles.dissipative if name in near]
            self._resisting = [*near.values(), *system.changing]
        held = np.flatnonzero(system.pattern.order < 0)
        self._in_held = np.searchsorted(held, moving)
        self._reacts = not self._damping and not system.changing
        bound = {term.name: term for term in system.terms}
        self._loads = [bound[name] for name in roles.loads]
        self._dissipative = [bound[name] for name in roles.dissipative]
        self._friction = [term for term in system.changing if term.name in roles.friction]

    def of_ends(self, *, balanced: bool) -> bool:
        """Whether work is that of what is held alone, which states at the ends of steps tell.

        Args:
            balanced: Whether steps end in balance.
        """
        busy = self._loads or self._dissipative or self._friction
        return not busy and (not self._moving.size or (balanced and self._reacts))

    def reacted(self, reactions: FloatArray | None) -> FloatArray | None:
        """Residual on the moving DOFs, of what terms do to all that are held; None where they do more."""
        return reactions.take(self._in_held, axis=-1) if reactions is not None and self._reacts else None

    def parts(self, before: Known, between: Sequence[State], after: Known) -> tuple[Part, ...]:
        """A step by its stages, each with its mean state.

        Forces at the mean state of a long step are others where much turns or bends in it. Where damping is
        stiff, velocities at the ends of stages ring, but not so their means.

        Args:
            before: The start.
            between: The ends of all stages but the last.
            after: The end.
        """
        if not self._loads and not self._dissipative:
            return ()
        known = (before.state, *between, after.state)
        return tuple(Part(*self._mean(start, end)) for start, end in pairwise(known))

    def of_holds(self, before: Known, after: Known, parts: Sequence[Part]) -> float:
        """Of what holds and drives: against all forces by the trapezoidal rule, and on masses.

        Mean forces, not forces of the mean state: there, edges that turn are shorter. What resists
        velocity does so at the mean states of the stages, as in :meth:`of_forces`.
        """
        moving = self._moving
        if not moving.size:
            return 0.0
        places, squares = zip(self._on_moving(before), self._on_moving(after), strict=True)
        path = places[1] - places[0]
        work = 0.5 * float(_dot(self._mass, squares[1] - squares[0]))
        if path.any():
            work += 0.5 * float(_dot(self._resistance(before) + self._resistance(after), path))
            if self._damping:
                still = np.ones(len(after.state.q), dtype=np.bool_)
                still[moving] = False
                work += _spent(self._damping, parts, still)
        return work

    def of_leap(self, before: Known, steps: Steps) -> FloatArray:
        """The same of each of many steps, shape (count,), where it is all work there is."""
        if not self._moving.size:
            return np.zeros(steps.count)
        q, v = steps.at_ends(self._moving)
        squares, forces = v**2, self.reacted(steps.reactions)
        assert forces is not None
        resistance = np.concatenate((self._resistance(before)[None], forces))
        path = q[1:] - q[:-1]
        work: FloatArray = 0.5 * _dot(self._mass, squares[1:] - squares[:-1])
        work += np.where(path.any(axis=1), 0.5 * _dot(resistance[:-1] + resistance[1:], path), 0.0)
        return work

    def of_forces(self, before: State, after: State, parts: Sequence[Part]) -> tuple[float, float, float]:
        """From outside, and into drag and into friction: at mean states, with second-order accuracy.

        Friction comes and goes within a step: it is taken as the step ends, where it is in balance. What it
        turns into heat beyond what the robot gives comes from obstacles that move.
        """
        rubbed = carried = 0.0
        if self._friction:
            c, moved = self._mean(before, after)
            frames = Carried(self._model.frames, after.frames, after.q)
            end = Configuration(after.law_time, after.q, after.v, frames, after.inputs)
            rubbed = (after.t - before.t) * sum(term.heat(end, c.v) for term in self._friction)
            carried = rubbed - _against(self._friction, end, moved)
        return carried - _spent(self._loads, parts), _spent(self._dissipative, parts), rubbed

    def in_time(self, terms: Sequence[BoundEnergy], before: Known, after: Known) -> float:
        """Of what changes energies at a fixed shape: the mean of that at both shapes."""
        if not terms:
            return 0.0
        late, early = before.at(after.state), after.at(before.state)
        stored = _stored(terms, after) - _stored(terms, before)
        crossed = sum(float(term.energy(late).sum()) for term in terms)
        crossed -= sum(float(term.energy(early).sum()) for term in terms)
        return 0.5 * (crossed + stored)

    def by_movers(self, terms: Sequence[BoundEnergy], before: Known, after: Known) -> float:
        """Of what moves within energies that are stiff in its place: mean powers by the trapezoidal rule.

        An obstacle may move in a step by more than it is deep in anything; its force hardly changes then.
        """
        if not terms:
            return 0.0
        dt = after.state.t - before.state.t
        return 0.5 * dt * (_power(terms, before, dt) + _power(terms, after, dt))

    def _mean(self, before: State, after: State) -> tuple[Configuration, FloatArray]:
        """The mean state of a step, moving as straight and evenly as the step goes, and the way gone."""
        q, moved = 0.5 * (before.q + after.q), after.q - before.q
        # pseudo-time has no speed
        v = moved / (after.t - before.t) if self._moves else np.zeros_like(q)
        frames = Carried(self._model.frames, before.frames, q)
        c = Configuration(0.5 * (before.law_time + after.law_time), q, v, frames, after.inputs)
        return c, moved

    def _on_moving(self, known: Known) -> tuple[FloatArray, FloatArray]:
        """Values of the moving DOFs, and the squares of their rates."""
        if known.moving is None:
            known.moving = known.state.q.take(self._moving), known.state.v.take(self._moving) ** 2
        return known.moving

    def _resistance(self, known: Known) -> FloatArray:
        """Residual on the moving DOFs."""
        if known.resistance is None:
            r = np.zeros(len(known.state.q))
            c = known.at(known.state)
            for term in self._resisting:
                term.add_residual(c, r)
            known.resistance = r.take(self._moving)
        return known.resistance


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Sums of products along the last axis, each rounded as if it were the only one."""
    return np.asarray((a * b).sum(axis=-1))


def _near(model: Model, roles: Roles, moving: IntArray) -> Iterator[Term]:
    """The terms as far as they may act on moving DOFs."""
    if not moving.size:
        return
    mask = np.zeros(model.dofs.n, dtype=np.bool_)
    mask[moving] = True
    elastic = {term.name: term for term in roles.elastic}
    for term in model.terms:
        near = elastic[term.name].touching(mask) if term.name in elastic else term
        if near is not None:
            yield near


def _spent(terms: Sequence[BoundTerm], parts: Sequence[Part], still: BoolArray | None = None) -> float:
    """Work done against terms in the parts of a step; on all DOFs, or on those that are not ``still``."""
    work = 0.0
    for part in parts if terms else ():
        moved = part.moved if still is None else np.where(still, 0.0, part.moved)
        work += _against(terms, part.mean, moved)
    return work


def _against(terms: Sequence[BoundTerm], c: Configuration, moved: FloatArray) -> float:
    """Residual of terms times displacement: the work done against them."""
    r = np.zeros(len(moved))
    for term in terms:
        term.add_residual(c, r)
    return float(r @ moved)


def _power(terms: Sequence[BoundEnergy], known: Known, dt: float) -> float:
    """Change of energies in time at a fixed shape [W]."""
    h = _QUOTIENT * dt
    late, early = (
        known.at(replace(known.state, t=t)) for t in (known.state.t + h, max(known.state.t - h, 0.0))
    )
    change = sum(float(term.energy(late).sum()) for term in terms)
    change -= sum(float(term.energy(early).sum()) for term in terms)
    return change / (late.t - early.t)


def _stored(terms: Sequence[BoundEnergy], known: Known) -> float:
    """Energy of terms at their own time."""
    total = 0.0
    for term in terms:
        if term.name not in known.energies:
            known.energies[term.name] = float(term.energy(known.at(known.state)).sum())
        total += known.energies[term.name]
    return total
