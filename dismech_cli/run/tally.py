"""What a run has cost: steps and wall time."""

from __future__ import annotations

import time
from dataclasses import dataclass

from ..model.saved import Arrays, Numbers


@dataclass(slots=True)
class Counters:
    """How often a run did what; implements :class:`~dismech_cli.model.saved.Saved`.

    Attributes:
        steps: Accepted steps.
        iterations: Newton iterations, those of failed steps included.
        cuts: Failed steps that were tried again, shorter.
        refused: Steps that were not accurate and tried again, shorter.
        rebuilds: Steps in which pairs that touch came to have places in the matrix, or lost them.
    """

    steps: int = 0
    iterations: int = 0
    cuts: int = 0
    rebuilds: int = 0
    refused: int = 0

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """All counts."""
        return {name: getattr(self, name) for name in self.__slots__}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Counters:
        """Count on from what was saved."""
        return Counters(**{name: int(numbers[name]) for name in self.__slots__})


class Stopwatch:
    """Wall time of a run; implements :class:`~dismech_cli.model.saved.Saved`."""

    def __init__(self) -> None:
        self._booked = dict.fromkeys(("bind", "solve", "observe", "write"), 0.0)
        self._before = 0.0
        self._began = time.monotonic()

    @property
    def elapsed(self) -> float:
        """Time of this process [s]."""
        return time.monotonic() - self._began

    @property
    def seconds(self) -> dict[str, float]:
        """Time of this process by phase, which add up to all of it [s].

        ``bind`` makes the matrices, ``solve`` steps, ``observe`` looks at fields, probes and energies,
        ``write`` writes; the rest is ``other``.
        """
        return {**self._booked, "other": self.elapsed - sum(self._booked.values())}

    @property
    def wall(self) -> float:
        """Time of all processes that worked on the run [s]."""
        return self._before + self.elapsed

    def book(self, phase: str, since: float) -> float:
        """Count the time since a tick as one of the phases.

        Args:
            phase: ``bind``, ``solve``, ``observe`` or ``write``.
            since: The tick: a reading of :func:`time.perf_counter` [s].

        Returns:
            The next tick.
        """
        now = time.perf_counter()
        self._booked[phase] += now - since
        return now

    def move(self, seconds: float, source: str, target: str) -> None:
        """Count some of the time of a phase as that of another [s]."""
        self._booked[source] -= seconds
        self._booked[target] = self._booked.get(target, 0.0) + seconds

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """The wall time."""
        return {"wall": self.wall}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Stopwatch:
        """Go on from the wall time that was saved."""
        self._before = float(numbers["wall"])
        return self
