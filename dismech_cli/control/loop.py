"""Loops: what they do to a state before a step goes on from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..model.saved import within
from ..model.state import State

if TYPE_CHECKING:
    from .channel import Channel
    from .controller import Controller, Memory
    from .sensor import Reading, Sensor
    from .target import Target

# A time this much before a sample, in periods, is that of the sample: rounding.
_ROUNDING: Final = 1e-9
_NEXT: Final = "next"


class Loop(Protocol):
    """A loop around the system; frozen: what it remembers lies in the state."""

    @property
    def name(self) -> str:
        """Name of the controller."""

    def start(self) -> Memory:
        """What it remembers at t = 0, under names of its own."""

    def act(self, state: State, target: float) -> State:
        """The state with what this loop puts in for a step to the time ``target`` [s].

        A step that is taken again, to an earlier time, asks again, from the same state or from the result.

        Raises:
            ControlError: The controller of a plugin fails, or commands what is no command.
        """

    def command(self, state: State) -> FloatArray:
        """What is added to natural strains at a state, shape (n,)."""


@frozen(kw_only=True)
class SampledLoop:
    """A controller that is asked once per period, and whose command is reached at the next sample.

    Samples have numbers: the n-th is taken at start + n period and at no other time, however long steps
    are.

    Attributes:
        name: Name of the controller.
        controller: What commands.
        sensors: What it reads.
        target: What it shall reach.
        channel: Where its commands go.
        period: Time between samples [s].
        first: Time of the first one [s].
        held: Whether a command is there at once and held, not reached by a ramp.
    """

    name: str
    controller: Controller
    sensors: tuple[Sensor, ...]
    target: Target
    channel: Channel
    period: float
    first: float = 0.0
    held: bool = False

    def start(self) -> Memory:
        """No sample taken."""
        sensed = {key: values for sensor in self.sensors for key, values in sensor.start().items()}
        own = {f"own.{key}": values for key, values in self.controller.start(self.channel.n).items()}
        return named(self.name, {_NEXT: np.zeros(1), **sensed, **own})

    def time(self, sample: int) -> float:
        """When a sample is taken [s]."""
        return self.first + sample * self.period

    def act(self, state: State, target: float) -> State:
        """Take a sample if it is time."""
        memory = within(lead(self.name), state.memory)
        sample = int(memory[_NEXT][0])
        now = self.time(sample)
        if state.t < now - _ROUNDING * self.period:
            return state
        read: list[FloatArray] = []
        kept: dict[str, FloatArray] = {_NEXT: np.array([sample + 1.0])}
        for sensor in self.sensors:
            values, waiting = sensor.read(state, sample, memory)
            read.append(values)
            kept |= waiting
        y = np.concatenate(read) if read else np.empty(0)
        wanted, own = self.controller.sample(now, y, self.target(now), within("own", memory))
        kept |= {f"own.{key}": values for key, values in own.items()}
        before = wanted if self.held else self.channel.value(state.t, state.inputs)
        inputs = self.channel.written(state.inputs, state.t, self.time(sample + 1), before, wanted)
        return replace(state, inputs=inputs, memory={**state.memory, **named(self.name, kept)})

    def command(self, state: State) -> FloatArray:
        """What is put in."""
        return self.channel.value(state.t, state.inputs)


@frozen(kw_only=True)
class IdealLoop:
    """Feedback inside the balance of forces; the integral alone is put in, step by step.

    Attributes:
        name: Name of the controller.
        reading: The strains.
        target: What they shall be.
        p: Gain of the error.
        i: Gain of its integral [1/s].
        weight: Share of the target in the error of p.
        forward: Share of the target that is commanded at once.
        integral: Channel of the integral over 1 + p, or None without one.
    """

    name: str
    reading: Reading
    target: Target
    p: float
    i: float
    weight: float
    forward: float
    integral: Channel | None

    def start(self) -> Memory:
        """Nothing: the integral lies in the inputs."""
        return {}

    def act(self, state: State, target: float) -> State:
        """Let the integral grow by the error there is, evenly over the step."""
        if self.integral is None:
            return state
        now = self.integral.value(state.t, state.inputs)
        error = self.target(state.t) - self.reading(state)
        later = now + self.i * (target - state.t) * error / (1.0 + self.p)
        inputs = self.integral.written(state.inputs, state.t, target, now, later)
        return replace(state, inputs=inputs)

    def command(self, state: State) -> FloatArray:
        """What the stiffer springs do, as a command to those there are."""
        r, y = self.target(state.t), self.reading(state)
        u: FloatArray = self.forward * r + self.p * (self.weight * r - y)
        if self.integral is None:
            return u
        return u + (1.0 + self.p) * self.integral.value(state.t, state.inputs)


@frozen
class Controls:
    """All loops of a system.

    Attributes:
        loops: The loops.
    """

    loops: tuple[Loop, ...] = ()

    def started(self, state: State, size: int) -> State:
        """The state with inputs that command nothing, shape (size,), and the memory of all loops."""
        if not self.loops:
            return state
        memory = {key: values for loop in self.loops for key, values in loop.start().items()}
        inputs = np.zeros(size)
        inputs.flags.writeable = False
        return replace(state, inputs=inputs, memory={**state.memory, **memory})

    def act(self, state: State, target: float) -> State:
        """The state with what all loops put in for a step to the time ``target`` [s]; itself if none does.

        Raises:
            ControlError: See :meth:`Loop.act`.
        """
        for loop in self.loops:
            state = loop.act(state, target)
        return state


UNCONTROLLED: Final = Controls()
"""Those of a system that nothing controls."""


def lead(name: str) -> str:
    """What the memory of a loop is led by in a state."""
    return f"control.{name}"


def named(name: str, memory: Memory) -> Mapping[str, FloatArray]:
    """The memory of a loop under the names it has in a state."""
    return {f"{lead(name)}.{key}": values for key, values in memory.items()}
