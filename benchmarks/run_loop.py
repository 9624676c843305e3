"""What a run costs beside its time steps, writers off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.output.frame import Frame
from dismech_cli.run.loop import Progress, run
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.step import Stepper

from .clock import in_turns
from .newton_iteration import DT, advance
from .scenes import cantilever, helix, stepper_of
from .table import table, verdict

STEPS, STEPS_PER_FRAME = 100, 10


@dataclass(frozen=True, slots=True)
class Nowhere:
    """A sink that keeps nothing."""

    def frame(self, frame: Frame) -> None: ...

    def event(self, kind: str, t: float, **details: object) -> None: ...

    def checkpoint(self, arrays: Mapping[str, FloatArray], numbers: Mapping[str, int | float]) -> None: ...

    def progress(self, progress: Progress) -> None: ...


def overhead(simulation: Simulation, *, seconds: float) -> float:
    """Time of a run over the time of its bare steps, less one; both set their stepper up."""

    def bare() -> None:
        stepper: Stepper = stepper_of(simulation)
        advance(stepper, stepper.prepare(stepper.rest_state()), DT, STEPS)

    turns = in_turns([lambda: run(simulation, Nowhere()), bare], seconds=seconds)
    return float(np.median(turns[:, 0] / turns[:, 1])) - 1.0


def report(quick: bool) -> str:
    """Overhead in percent."""
    rows = []
    for name, scene in (
        ("helix, framed", helix),
        ("cantilever, planar", lambda nodes, **numerics: cantilever(nodes, dimension=2, **numerics)),
    ):
        for kernels in ("numba", "numpy"):
            simulation = scene(101, kernels=kernels, dt=DT, t_end=STEPS * DT)
            silent, observed = (
                100.0 * overhead(replace(simulation, frame_every=k * DT), seconds=1.0 if quick else 6.0)
                for k in (STEPS, STEPS_PER_FRAME)
            )
            rows.append((name, kernels, verdict(silent, 10.0), observed))
    return "\n\n".join(
        (
            f"## Run loop beside the steps\n\n101 nodes, {STEPS} steps, writers off: frames at start and end "
            f"alone; then with one every {STEPS_PER_FRAME} steps, energies measured, none written:",
            table(("scene", "kernels", "overhead [%]", "with frames [%]"), rows),
        )
    )
