"""Whether sampled loops can be stable: the system and its controllers as one matrix from sample to sample.

It is taken where the run starts, by differences of one period stepped again and again: once for every DOF,
its rate, and every command. So inertia, time steps, ramps and delays are in it, and what the system does by
itself too; limits and noise are not, nor anything that the system does elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import LawError
from ..frozen import frozen
from ..model.state import State
from ..solve.status import Status
from ..solve.step import Stepper
from .controller import Linear
from .loop import SampledLoop

# What grows by less than this share from sample to sample is held for steady: motions that nothing resists
# do not die out, and differences are not exact.
_GROWTH: Final = 1e-3
# Positions are moved by this share of an edge, angles by as many radians, commands by this share of the
# largest target.
_MOVE: Final = 1e-6
_TRIES: Final = 20


@frozen
class Gain:
    """What loops do.

    Attributes:
        reach: Largest share of the way to a command that a place goes in a period.
        growth: Factor by which errors grow from sample to sample at last; above 1 they never end.
        alone: The same without the loops.
        margin: By how much all gains could be multiplied until errors grow.
    """

    reach: float
    growth: float
    alone: float
    margin: float

    @property
    def stable(self) -> bool:
        """Whether errors may die out, or the loops are not what keeps them alive."""
        return self.growth <= max(self.alone, 1.0) + _GROWTH


def steps_needed(loops: Sequence[SampledLoop], free: int, steps: int) -> int:
    """Time steps that :func:`loop_gain` takes.

    Args:
        loops: The loops.
        free: Number of free DOFs.
        steps: Time steps of a period.
    """
    return steps * (1 + 2 * free + 2 * sum(loop.channel.n for loop in loops))


def loop_gain(loops: Sequence[SampledLoop], stepper: Stepper, start: State, times: FloatArray) -> Gain | None:
    """What loops of one period do together; None where the first period cannot be stepped.

    Args:
        loops: Loops with linear laws.
        stepper: Takes steps; converged well, since differences are taken.
        start: The system at t = 0, as it begins.
        times: Of the steps of one period, from 0 to its end [s].
    """
    try:
        plant = _Plant.of(loops, stepper, start, times)
    except ArithmeticError:
        return None

    def growth(share: float) -> float:
        return float(np.abs(np.linalg.eigvals(_closed(loops, plant, share))).max())

    alone = growth(0.0)
    reach = plant.read @ plant.after
    return Gain(float(np.diag(reach).max()), growth(1.0), alone, _margin(growth, max(alone, 1.0)))


@frozen
class _Plant:
    """The system over one period, linear about its start: x' = A x + B0 u0 + B1 u1, y = C x.

    Attributes:
        own: A, shape (X, X).
        before: B0, by commands as the period starts, shape (X, U).
        after: B1, by commands as it ends, shape (X, U).
        read: C, shape (U, X).
    """

    own: FloatArray
    before: FloatArray
    after: FloatArray
    read: FloatArray

    @classmethod
    def of(cls, loops: Sequence[SampledLoop], stepper: Stepper, start: State, times: FloatArray) -> _Plant:
        """By differences.

        Raises:
            ArithmeticError: A step fails.
        """
        start = stepper.prepare(start)
        free, model = stepper.system.pattern.free, stepper.model
        period = float(times[-1] - times[0])
        scale = np.where(free < model.dofs.n_positions, model.length, 1.0)
        units = np.concatenate((scale, scale / period))

        def told(state: State) -> FloatArray:
            x: FloatArray = np.concatenate((state.q[free], state.v[free])) / units
            return x

        still = told(_over(stepper, start, times))
        own, read = [], []
        seen = _seen(loops, start)
        for place in range(2 * len(free)):
            moved = _moved(stepper, start, free, place, _MOVE * units[place])
            own.append((told(_over(stepper, moved, times)) - still) / _MOVE)
            read.append((_seen(loops, moved) - seen) / _MOVE)
        ends: tuple[list[FloatArray], list[FloatArray]] = ([], [])
        for loop in loops:
            size = _size(loop)
            for unit in np.eye(loop.channel.n):
                nothing = np.zeros_like(unit)
                ramps = ((size * unit, nothing), (nothing, size * unit))
                if loop.held:
                    ramps = ((nothing, nothing), (size * unit, size * unit))
                for side, (first, last) in zip(ends, ramps, strict=True):
                    inputs = loop.channel.written(
                        start.inputs, float(times[0]), float(times[-1]), first, last
                    )
                    end = _over(stepper, replace(start, inputs=inputs), times)
                    side.append((told(end) - still) / size)
        columns = (np.stack(part, axis=1) for part in (own, *ends, read))
        return cls(*columns)


def _over(stepper: Stepper, state: State, times: FloatArray) -> State:
    """The state a period later.

    Raises:
        ArithmeticError: A step fails.
    """
    with np.errstate(all="ignore"):
        for t in times[1:]:
            state = stepper.prepare(state)
            result = stepper.step(state, float(t) - state.t)
            if result.status is not Status.CONVERGED:
                raise ArithmeticError(result.status.name)
            state = result.state
    return state


def _moved(stepper: Stepper, state: State, free: IntArray, place: int, by: float) -> State:
    """A state with one position or rate moved."""
    q, v = state.q.copy(), state.v.copy()
    dof = free[place % len(free)]
    (q if place < len(free) else v)[dof] += by
    return replace(state, q=q, v=v, frames=stepper.model.frames.transport(state.frames, q).state)


def _seen(loops: Sequence[SampledLoop], state: State) -> FloatArray:
    """What all loops read, without noise and delay."""
    return np.concatenate([loop.sensors[0].reading(state) for loop in loops])


def _size(loop: SampledLoop) -> float:
    """By how much a command is moved."""
    largest = 0.0
    with suppress(LawError):  # it may have no value after the end of the run
        for k in range(0, 1000, 10):
            largest = max(largest, float(np.abs(loop.target(loop.time(k))).max(initial=0.0)))
    return 1e3 * _MOVE * (largest or 1.0)


def _closed(loops: Sequence[SampledLoop], plant: _Plant, share: float) -> FloatArray:
    """The matrix from sample to sample with all gains times a share.

    Its places: what moves, the commands before, and for each loop readings on their way and what its
    controller remembers.
    """
    laws = [loop.controller.scaled(share) for loop in loops if isinstance(loop.controller, Linear)]
    sizes = [loop.channel.n for loop in loops]
    keys = [list(law.start(n)) for law, n in zip(laws, sizes, strict=True)]
    lates = [loop.sensors[0].late for loop in loops]
    moving, commands = len(plant.own), sum(sizes)
    size = (
        moving
        + commands
        + sum(n * (late + len(names)) for n, late, names in zip(sizes, lates, keys, strict=True))
    )
    out = np.empty((size, size))
    for column, unit in enumerate(np.eye(size)):
        x, before, rest = np.split(unit, [moving, moving + commands])
        y = plant.read @ x
        given, left = [], []
        for law, n, names, late in zip(laws, sizes, keys, lates, strict=True):
            own, y = y[:n], y[n:]
            parts, rest = rest[: n * (late + len(names))].reshape(-1, n), rest[n * (late + len(names)) :]
            seen = np.concatenate((parts[:late], own[None]))
            memory = dict(zip(names, parts[late:], strict=True))
            command, kept = law.sample(0.0, seen[0], np.zeros(n), memory)
            given.append(command)
            left += [*seen[1:], *(kept[name] for name in names)]
        now = np.concatenate(given)
        after = plant.own @ x + plant.before @ before + plant.after @ now
        out[:, column] = np.concatenate((after, now, *left))
    return out


def _margin(growth: Callable[[float], float], least: float) -> float:
    """The share of all gains at which errors begin to grow, to a hundredth."""
    low, high = 0.0, 1.0
    for _ in range(_TRIES):
        if growth(high) > least + _GROWTH:
            break
        low, high = high, 2.0 * high
    else:
        return np.inf
    while high - low > 1e-2 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if growth(middle) > least + _GROWTH else (middle, high)
    return low
