"""Cost of a Newton iteration with everything it needs, in units of the yardstick R(N).

The measure is the CPU time of time steps of a real dynamic scene, divided by the number of linear
solves in them. Transport of frames, terms, assembly, factorisation, solution, convergence test,
predictor and acceptance of the step are all in it; a step of three iterations assembles four times.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dismech_cli.model.state import State
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

from .clock import in_turns, yardstick
from .scenes import cantilever, helix, stepper_of
from .split import PARTS, Split, timed_stepper
from .table import table, verdict

DT = 5e-3
SCENES: dict[str, Callable[..., Simulation]] = {
    "helix, framed": helix,
    "cantilever, isotropic": lambda nodes, **numerics: cantilever(nodes, dimension=3, **numerics),
    "cantilever, planar": lambda nodes, **numerics: cantilever(nodes, dimension=2, **numerics),
}
# Bars of the scenes in their order by kernels and nodes, in R(N).
BARS = {
    "numba": {101: (1.6, 0.9, 0.7), 1000: (1.9, 0.9, 0.6), 20_000: (3.0, 2.25, 1.5)},
    "numpy": {101: (25.0, 18.75, 12.5), 1000: (7.0, 5.25, 3.5), 20_000: (6.0, 4.5, 3.0)},
}


@dataclass(frozen=True, slots=True)
class Iteration:
    """CPU times of one Newton iteration [s].

    Attributes:
        total: Everything.
        ratio: Over the yardstick, median of the turns.
        per_step: Iterations per step.
        parts: The entries of ``PARTS``, of steps that read the clock between them: their sum is
            more than ``total`` by these readings.
    """

    total: float
    ratio: float
    per_step: float
    parts: Mapping[str, float]


# What one call of the yardstick does, for a scene bound to its matrix and in motion.
Yard = Callable[[Stepper, State], Callable[[], object]]


def measure(simulation: Simulation, yard: Yard, *, steps: int, seconds: float) -> Iteration:
    """Time steps of a scene in turns with a yardstick, after ten steps that bring it into motion."""
    stepper = stepper_of(simulation)
    start, _ = advance(stepper, stepper.prepare(stepper.rest_state()), DT, 10)
    _, iterations = advance(stepper, start, DT, steps)
    split = Split()
    watched = timed_stepper(simulation, start, split)
    actions = [
        lambda: advance(stepper, start, DT, steps),
        yard(stepper, start),
        lambda: split.lap(lambda: advance(watched, start, DT, steps)),
    ]
    turns = in_turns(actions, seconds=seconds)
    total = float(turns[:, 0].min()) / iterations
    ratio = float(np.median(turns[:, 0] / turns[:, 1])) / iterations
    parts = {part: spent / iterations for part, spent in split.least.items()}
    return Iteration(total, ratio, iterations / steps, parts)


def banded(nodes: int) -> Yard:
    """The yardstick R(N) of rods, which is the same for all scenes."""
    return lambda stepper, start: yardstick(nodes)


def advance(stepper: Stepper, state: State, dt: float, steps: int) -> tuple[State, int]:
    """Take steps; return the last state and the iterations of all."""
    iterations = 0
    for _ in range(steps):
        result = stepper.step(state, dt)
        if result.status is not Status.CONVERGED:
            raise RuntimeError(f"the step to t = {state.t + dt:g} s ended with {result.status.name}")
        state, iterations = result.state, iterations + result.iterations
    return state, iterations


def split_table(head: Sequence[str], rows: Sequence[tuple[Sequence[object], Iteration]]) -> str:
    """Milliseconds of the parts of iterations, and their sum, with the columns that name them."""
    cells = [
        (*names, *[1e3 * s for s in (*one.parts.values(), sum(one.parts.values()))]) for names, one in rows
    ]
    return "\n\n".join(
        (
            "Where the time goes [ms per iteration]: steps of the same scene once more, in turns with those "
            "above, that read the clock wherever one part hands over to another; the lap that took least, "
            "which is longer by these readings. A step assembles once more than it solves, which is in "
            "these numbers. Terms include the scatter into the matrix; assembly is clearing, inertia and the "
            "sizes of forces; the rest is predictor, convergence test and acceptance of the step:",
            table((*head, *PARTS, "sum"), cells),
        )
    )


def report(quick: bool) -> str:
    """Ratios with their bars, and the split."""
    ratios, splits = [], []
    for kernels, bars in BARS.items():
        for nodes, of_scenes in bars.items():
            for (name, scene), bar in zip(SCENES.items(), of_scenes, strict=True):
                simulation = scene(nodes, kernels=kernels, dt=DT, t_end=1.0)
                steps = 20 if nodes < 10_000 else 2
                one = measure(simulation, banded(nodes), steps=steps, seconds=1.0 if quick else 5.0)
                ratios.append(
                    (
                        kernels,
                        nodes,
                        name,
                        1e3 * one.total,
                        verdict(one.ratio, bar),
                        one.per_step,
                    )
                )
                splits.append(((kernels, nodes, name), one))
    return "\n\n".join(
        (
            "## One Newton iteration, everything included\n\n"
            f"Dynamic scenes of 5 mm edges with steps of {1e3 * DT:g} ms (TR-BDF2, two stages); CPU time "
            "of the steps over the linear solves in them. R(N) is timed in turns with the steps; median of "
            "the ratios.",
            table(("kernels", "nodes", "scene", "ms", "in R(N)", "iterations per step"), ratios),
            split_table(("kernels", "nodes", "scene"), splits),
        )
    )
