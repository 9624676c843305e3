"""What `dismech check` says that shipped scenes take, against what they take.

python -m benchmarks check_times [NAME ...]      measures scenes: benchmarks/results/check_times.json
"""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.model.saved import Arrays, Numbers
from dismech_cli.output.frame import Frame
from dismech_cli.run.interrupt import StopRequest
from dismech_cli.run.loop import run
from dismech_cli.run.sink import Progress
from dismech_cli.scenario.load import load
from dismech_cli.session.duration import iteration_time, seconds, work_of

SCENARIOS: Final = Path(__file__).parents[1] / "scenarios"
KEPT: Final = Path(__file__).with_name("results") / "check_times.json"
# Scenes that take longer are measured as far as they come in so many CPU seconds.
_LONG: Final = 3.0


@dataclass
class _Timer:
    """Starts after the first step, in which kernels are compiled; a sink."""

    stop: StopRequest = field(default_factory=StopRequest)
    began: float = 0.0
    first: tuple[float, int, int] = (0.0, 0, 0)
    last: tuple[float, int, int] = (0.0, 0, 0)
    seconds: float = 0.0

    def frame(self, frame: Frame) -> None:
        """Nothing."""

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Nothing."""

    def event(self, kind: str, t: float, **details: object) -> None:
        """Nothing."""

    def progress(self, progress: Progress) -> None:
        """Look at the clock."""
        self.last = (progress.t, progress.steps, progress.iterations)
        if not self.began:
            self.began, self.first = time.process_time(), self.last
            return
        self.seconds = time.process_time() - self.began
        if self.seconds > _LONG:
            self.stop.signal = signal.SIGTERM


def scenes() -> list[Path]:
    """All of the gallery that need no plugin."""
    return sorted([*SCENARIOS.glob("*.yaml"), *(SCENARIOS / "verification").glob("*.yaml")])


def measured(path: Path) -> dict[str, Any]:
    """A scene: its sizes, and its CPU time, by extrapolation in simulated time where it is long."""
    loaded = load(path)
    composition = compose(loaded)
    simulation, timer = composition.simulation, _Timer()
    run(simulation, timer, stop=timer.stop)
    share = (timer.last[0] - timer.first[0]) / simulation.control.t_end
    steps, iterations = (timer.last[k] - timer.first[k] for k in (1, 2))
    return timed(path) | {
        "cpu": timer.seconds / share if share > 0.0 else None,
        "steps": steps / share if share > 0.0 else 1,
        "iterations": iterations / share if share > 0.0 else timer.last[2],
    }


def timed(path: Path) -> dict[str, Any]:
    """What `check` goes by: the work of a scene, and the time of an iteration."""
    loaded = load(path)
    composition = compose(loaded)
    plan = composition.plan
    work = work_of(composition, loaded.scenario.numerics)
    look = 0.0 if plan.whole else iteration_time(composition.simulation)
    return {
        "work": asdict(work),
        "kernels": plan.kernels,
        "whole": plan.whole,
        "iteration": look,
        "said": seconds(work, plan.kernels, look, whole=plan.whole),
    }


def main(names: Sequence[str]) -> None:
    """Measure scenes; only what `check` goes by with ``--said``."""
    if "--said" in names:
        _say()
        return
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    for path in scenes():
        if path.stem not in names if names else path.stem in kept:
            continue
        try:
            kept[path.stem] = measured(path)
        except ScenarioError as error:
            print(path.stem, error, flush=True)
            continue
        KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        one = kept[path.stem]
        print(path.stem, one["cpu"], one["said"], flush=True)


def _say() -> None:
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    for path in scenes():
        if path.stem in kept:
            kept[path.stem] |= timed(path)
            KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
