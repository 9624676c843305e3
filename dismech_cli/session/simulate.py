"""Run a scenario from Python, frames in memory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..arrays import FloatArray
from ..compose.compose import Composition, compose
from ..output.frame import Frame
from ..run.loop import Outcome, run
from ..run.sink import Progress
from ..scenario.load import LoadedScenario, load


@dataclass
class Memory:
    """A sink that keeps frames and events."""

    frames: list[Frame] = field(default_factory=list)
    events: list[tuple[str, float, Mapping[str, object]]] = field(default_factory=list)
    arrays: Mapping[str, FloatArray] = field(default_factory=dict)
    numbers: Mapping[str, int | float] = field(default_factory=dict)

    def frame(self, frame: Frame) -> None:
        """Keep it."""
        self.frames.append(frame)

    def event(self, kind: str, t: float, **details: object) -> None:
        """Keep it."""
        self.events.append((kind, t, details))

    def checkpoint(self, arrays: Mapping[str, FloatArray], numbers: Mapping[str, int | float]) -> None:
        """Keep the latest."""
        self.arrays, self.numbers = arrays, numbers

    def progress(self, progress: Progress) -> None:
        """Say nothing."""


@dataclass(frozen=True, slots=True)
class Result:
    """A finished run in memory.

    Attributes:
        outcome: How it ended, last state, watched values.
        frames: All frames.
        built: Simulation and plan.
    """

    outcome: Outcome
    frames: tuple[Frame, ...]
    built: Composition


def simulate(scenario: LoadedScenario | str | Path) -> Result:
    """Run a scenario to its end without writing anything.

    Args:
        scenario: As loaded, or the path of its file.

    Raises:
        ScenarioError: It cannot be read or built.
    """
    loaded = scenario if isinstance(scenario, LoadedScenario) else load(scenario)
    built = compose(loaded)
    memory = Memory()
    outcome = run(built.simulation, memory)
    return Result(outcome, tuple(memory.frames), built)
