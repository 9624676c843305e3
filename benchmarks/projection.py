"""Projected tangents where they pay, and where they do not: statics past buckling, plates without it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from dismech_cli.kernels.projection import ProjectedDriver
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.status import Status
from dismech_cli.solve.tangents import TANGENTS

from .newton_iteration import DT
from .scenes import gallery, simulation_of, stepper_of
from .shell_scenes import sheet
from .table import table


@dataclass(frozen=True, slots=True)
class Ride:
    """Some steps of a scene.

    Attributes:
        iterations: Linear solves.
        seconds: CPU time [s].
        end: ``done``, or how the first failed step ended.
        negative: Negative eigenvalues of the stiffness at the end of statics.
    """

    iterations: int
    seconds: float
    end: str
    negative: str


def variants(simulation: Simulation) -> dict[str, Simulation]:
    """The choices of the scenario language, and projection of every tangent."""
    out = {
        name: replace(simulation, newton=replace(simulation.newton, factorize=factorize))
        for name, factorize in TANGENTS.items()
    }
    model = replace(simulation.model, driver=ProjectedDriver(simulation.model.driver))
    return out | {"always (not offered)": replace(simulation, model=model)}


def ride(simulation: Simulation, dt: float, steps: int) -> Ride:
    """Take steps without cutting any."""
    stepper = stepper_of(simulation)
    state = stepper.prepare(stepper.rest_state())
    iterations, end, start = 0, "done", time.process_time()
    for _ in range(steps):
        result = stepper.step(stepper.prepare(state), dt)
        state, iterations = result.state, iterations + result.iterations
        if result.status is not Status.CONVERGED:
            end = f"{result.status.name.lower()} at t = {state.t:.2g}"
            break
    spent = time.process_time() - start
    static = not simulation.model.mass.any()
    return Ride(iterations, spent, end, str(stepper.stability.negative_eigenvalues(state)) if static else "")


def report(quick: bool) -> str:
    """Iterations and time of each choice on each scene."""
    falling = sheet(1000, bending="hinge", dt=DT, t_end=1.0, kernels="numpy")
    scenes = [
        (f"strip buckles, {count} load steps", simulation_of(gallery("buckled_strip", (
            f"numerics.integrator.load_steps={count}", "numerics.kernels=numpy",
        ))), 1.0 / count, count)
        for count in (5, 20)
    ]  # fmt: skip
    plate = simulation_of(gallery("plate", ("geometry[0].generate.divisions=20", "numerics.kernels=numpy")))
    scenes += [("plate sags, 1 load step", plate, 1.0, 1), ("sheet falls, 20 steps", falling, DT, 20)]
    rows = []
    for title, simulation, dt, steps in scenes:
        for name, variant in variants(simulation).items():
            print(f"  {title}: {name}", flush=True)
            one = ride(variant, dt, steps)
            rows.append((title, name, one.iterations, one.seconds, one.end, one.negative))
    return "\n\n".join(
        (
            "## Projection of stencils to positive semi-definite tangents\n\n"
            "`numerics.newton.projection`, with NumPy kernels and without cutting steps. Statics that keep "
            "negative eigenvalues have stayed on a branch that is not stable:",
            table(
                ("scene", "projection", "iterations", "CPU [s]", "end", "negative eigenvalues"),
                rows,
            ),
        )
    )
