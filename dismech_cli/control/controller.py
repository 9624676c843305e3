"""The protocols of controllers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, Self, TypeAlias, runtime_checkable

from ..arrays import FloatArray

Memory: TypeAlias = Mapping[str, FloatArray]
"""What a controller remembers from sample to sample, by name: arrays of numbers and nothing else."""


class Controller(Protocol):
    """Commands from readings, once per period. Pure: what it remembers comes in and goes out.

    So a run can be cut, stopped and resumed at any step, and is the same run. The classes of plugins keep
    this protocol too.
    """

    def start(self, n: int) -> Memory:
        """What it remembers before the first sample.

        Args:
            n: Length of its command.
        """

    def sample(self, t: float, y: FloatArray, r: FloatArray, memory: Memory) -> tuple[FloatArray, Memory]:
        """The command until the next sample, and what is remembered.

        Args:
            t: Time [s].
            y: Readings, shape (m,).
            r: Target now, shape (n,); (0,) where none is given.
            memory: As the last call, or :meth:`start`, left it.

        Returns:
            What is added to the natural strains, shape (n,), and the memory.
        """


@runtime_checkable
class Linear(Controller, Protocol):
    """A controller that is linear but for its limits."""

    def scaled(self, share: float) -> Self:
        """With all gains times a share, and without limits."""
