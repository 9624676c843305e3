"""One point of a study: a run whose quantities are read after every step, within a limit of CPU time."""

from __future__ import annotations

import signal
import time
from collections.abc import Mapping
from dataclasses import field, replace
from math import inf, nan
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...compose.compose import compose
from ...errors import ScenarioError
from ...frozen import frozen
from ...model.saved import Arrays, Numbers
from ...output.frame import Frame
from ...run.interrupt import StopRequest
from ...run.loop import End, run
from ...run.sink import Progress
from ...scenario.language.study import Measured
from ..sweep.points import Base
from .peak_memory import peak_memory, watch_peak
from .space import Setting
from .yardstick import Courses

# Cuts that a run may have: some, and a quarter of its steps.
_CUTS, _CUT_SHARE = 20, 0.25
# CPU time that a point may take [s]: the first one, and others at least and beyond what is expected.
_CAP, _LEAST_CAP, _DEARER = 300.0, 10.0, 4.0

DONE: Final = "done"
SHAPE: Final = "shape"
"""Quantity that every scenario has, unless a probe of it has that name: the nodes of its frames."""


@frozen(kw_only=True)
class Point:
    """A run that was made.

    Attributes:
        settings: What it set.
        status: ``done``, or why it is unstable here: ``failed``, ``cuts``, ``cpu``.
        message: Why, in words.
        doubts: What makes a run doubtful that came to its end, a line each.
        cpu: CPU time of its steps but the first, in which kernels are compiled [s].
        steps: How many.
        iterations: Newton iterations.
        cuts: Steps that were cut.
        size: Steps times degrees of freedom.
        order: Of the integrator.
        t_end: End of the run.
        memory: The most that the process had while it ran [byte]; NaN where that is not known.
        courses: Its quantities.
    """

    settings: tuple[Setting, ...]
    status: str
    message: str
    cpu: float
    steps: int
    iterations: int
    cuts: int
    size: float
    order: int
    t_end: float
    memory: float = nan
    doubts: tuple[str, ...] = ()
    courses: Courses = field(repr=False)

    @property
    def stable(self) -> bool:
        """Whether it came to its end."""
        return self.status == DONE

    @property
    def label(self) -> str:
        """What it set, on one line."""
        return ", ".join(f"{key}={text}" for key, text in self.settings)


class _Watch:
    """Stops a run that costs too much; a sink."""

    def __init__(self, asked: StopRequest, cap: float, steps: int) -> None:
        self._asked, self._cap = asked, cap
        self.stop = StopRequest()
        self._cuts = _CUTS + _CUT_SHARE * steps
        self.began: float | None = None
        self.cuts = 0
        self.why = ""
        self._shapes: list[tuple[float, FloatArray]] = []

    def frame(self, frame: Frame) -> None:
        """Keep the shape."""
        self._shapes.append((frame.t, frame.positions))

    @property
    def shapes(self) -> tuple[FloatArray, FloatArray]:
        """Times [s] and shapes of the frames, (K,) and (K, N, 3)."""
        times, shapes = zip(*self._shapes, strict=True)
        return np.array(times), np.array(shapes)

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Nothing."""

    def event(self, kind: str, t: float, **details: object) -> None:
        """Count the cuts."""
        self.cuts += kind == "step_cut"
        if self.cuts > self._cuts:
            self._end("cuts")

    def progress(self, progress: Progress) -> None:
        """Look at the clock; it starts after the first step."""
        self.stop.signal = self.stop.signal or self._asked.signal
        if self.began is None:
            self.began = time.process_time()
        elif self.spent > self._cap:
            self._end("cpu")

    @property
    def spent(self) -> float:
        """CPU time since the first step [s]."""
        return 0.0 if self.began is None else time.process_time() - self.began

    def _end(self, why: str) -> None:
        if not self.why:
            self.why = why
            self.stop.signal = signal.SIGTERM


def measure(
    base: Base,
    settings: tuple[Setting, ...],
    quantities: Mapping[str, Measured],
    price: float,
    stop: StopRequest,
) -> Point:
    """Run a point.

    Args:
        base: The scenario.
        settings: What the point sets.
        quantities: What is read.
        price: CPU time per step and degree of freedom that other points took [s]; infinite if none did.
        stop: Set by signals.

    Raises:
        ScenarioError: It cannot be read or composed, or has no such probe.
        KeyboardInterrupt: A signal came.
    """
    loaded = base.load([f"{key}={text}" for key, text in settings])
    simulation = compose(loaded).simulation
    watched = {
        name: simulation.probes[one.probe]
        for name, one in quantities.items()
        if one.probe in simulation.probes
    }
    shapes = [name for name in quantities if name not in watched]
    for name in shapes:
        if quantities[name].probe != SHAPE:
            raise ScenarioError(f"study: no probe {quantities[name].probe!r} in output.probes")
        if quantities[name].norm not in ("max", "rms"):
            raise ScenarioError(f"study: of the shape there is 'max' and 'rms', no {quantities[name].norm!r}")
    steps = simulation.control.steps
    expected = price * steps * simulation.model.dofs.n
    watch = _Watch(stop, max(_DEARER * expected, _LEAST_CAP) if expected < inf else _CAP, steps)
    watch_peak()
    outcome = run(replace(simulation, watched=watched), watch, stop=watch.stop)
    spent = watch.spent
    if stop.requested:
        raise KeyboardInterrupt
    failed = "failed" if outcome.end is End.FAILED else ""
    steps = outcome.counters["steps"]
    return Point(
        settings=settings,
        status=watch.why or failed or DONE,
        message=outcome.message.partition("\n")[0] if failed else _WHY.get(watch.why, ""),
        # the first step is one of many alike
        cpu=spent * steps / (steps - 1) if steps > 1 else nan,
        steps=steps,
        iterations=outcome.counters["iterations"],
        cuts=outcome.counters["cuts"],
        size=float(steps * simulation.model.dofs.n),
        order=simulation.integrator.order,
        t_end=simulation.control.t_end,
        memory=peak_memory(),
        doubts=outcome.doubts,
        courses={name: (outcome.times, values) for name, values in outcome.watched.items()}
        | {name: watch.shapes for name in shapes},
    )


_WHY: Final = {"cuts": "too many steps had to be cut", "cpu": "far dearer than others of its size"}
