"""What a run costs beside its time steps, writers off."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.output.frame import Frame
from dismech_cli.run.clock import Clock
from dismech_cli.run.loop import run
from dismech_cli.run.simulation import Simulation
from dismech_cli.run.sink import Progress

from .clock import in_turns
from .newton_iteration import DT, advance
from .scenes import cantilever, gallery, helix, simulation_of, stepper_of
from .table import table, verdict

NODES, STEPS, STEPS_PER_FRAME = 101, 100, 10
_BAR = 15.0  # [%]


def _falling(scene: Callable[..., Simulation], **options: object) -> Callable[[str], Simulation]:
    return lambda kernels: scene(NODES, kernels=kernels, dt=DT, t_end=STEPS * DT, **options)


def _driven(name: str, *overrides: str) -> Callable[[str], Simulation]:
    """A scene of the gallery with more nodes, as bare as the others: nothing watched or written."""
    bare = [f"geometry[0].generate.nodes={NODES}", "numerics.dt=10 ms", f"numerics.t_end={10 * STEPS} ms"]
    bare += ["expect={}", "output.fields=[]", "output.probes={}", "output.render={}"]
    return lambda kernels: simulation_of(gallery(name, (*bare, *overrides, f"numerics.kernels={kernels}")))


SCENES: dict[str, Callable[[str], Simulation]] = {
    "helix, framed": _falling(helix),
    "cantilever, planar": _falling(cantilever, dimension=2),
    # five times as large, because its end would be pushed an edge further in each step
    "contortion, framed: end pushed and twisted": _driven(
        "contortion",
        "geometry[0].generate.to=[500 mm, 0, 0]",
        "geometry[0].radius=5 mm",
        f"motions[1].where.nodes.range=[{NODES - 3}, {NODES - 1}]",
    ),
    "snake_21, framed: curvature driven, resistive force": _driven("snake_21"),
}


class Nowhere:
    """A sink that keeps nothing."""

    def frame(self, frame: Frame) -> None: ...

    def event(self, kind: str, t: float, **details: object) -> None: ...

    def checkpoint(self, arrays: Mapping[str, FloatArray], numbers: Mapping[str, int | float]) -> None: ...

    def progress(self, progress: Progress) -> None: ...


def grid_of(simulation: Simulation) -> FloatArray:
    """Times between which the steps of a run are fixed before it starts [s], shape (steps + 1,)."""
    assert isinstance(simulation.control, Clock)
    return simulation.control.grid


def overhead(simulation: Simulation, *, seconds: float) -> float:
    """Time of a run over the time of its bare steps, less one; both set their stepper up."""

    def bare() -> None:
        stepper = stepper_of(simulation)
        state = stepper.prepare(stepper.rest_state())
        for t in grid_of(simulation)[1:].tolist():
            state, _ = advance(stepper, state, t - state.t, 1)
            state = replace(state, t=t)  # as the run: its steps are the same to the last bit

    turns = in_turns([lambda: run(simulation, Nowhere()), bare], seconds=seconds)
    return float(np.median(turns[:, 0] / turns[:, 1])) - 1.0


def report(quick: bool) -> str:
    """Overhead in percent."""
    rows = []
    for name, scene in SCENES.items():
        for kernels in ("numba", "numpy"):
            simulation = scene(kernels)
            silent, observed = (
                100.0
                * overhead(
                    replace(simulation, frame_every=k * float(grid_of(simulation)[1])),
                    seconds=1.0 if quick else 6.0,
                )
                for k in (STEPS, STEPS_PER_FRAME)
            )
            rows.append((name, kernels, verdict(silent, _BAR), verdict(observed, _BAR)))
    return "\n\n".join(
        (
            f"## Run loop beside the steps\n\n{NODES} nodes, {STEPS} steps, writers off. CPU time that a run "
            "takes more than the same steps alone, with frames at start and end only; then with one every "
            f"{STEPS_PER_FRAME} steps, energies measured, none written. Work is booked in every step: where "
            "ends are moved, curvature is driven or the surroundings resist, that evaluates energies and "
            "forces again. A run takes the compiled steps between two frames in one, the others one by one, "
            "and may take less than they:",
            table(("scene", "kernels", "overhead [%]", "with frames [%]"), rows),
        )
    )
