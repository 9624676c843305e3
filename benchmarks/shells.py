"""Cost of a Newton iteration of shells with everything it needs, in units of the yardstick S(T).

S(T) is the time in which PARDISO factorises the scene's own matrix, taken as positive definite and
analysed before, and solves with it once: what an iteration costs at least that factorises. Where factors are
kept within a step, iterations cost less than that.
Memory is the peak of a child process that builds the scene and takes one step.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dismech_cli.model.state import State
from dismech_cli.output.frame import Frame
from dismech_cli.output.writers import make_writer
from dismech_cli.run.loop import Limits, run
from dismech_cli.run.simulation import Simulation
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS
from dismech_cli.solve.linear.pardiso import POSITIVE_DEFINITE, PardisoFactors
from dismech_cli.solve.step import Stepper
from dismech_cli.solve.system import System

from .clock import exponent, in_turns
from .newton_iteration import DT, Iteration, advance, measure, split_table
from .run_loop import Nowhere
from .scenes import stepper_of
from .shell_scenes import sheet
from .table import table, verdict

BENDING = ("hinge", "averaged", "midedge")
MODELS = {"numba": BENDING, "numpy": ("hinge",)}
# Bars of an iteration with hinges by kernels and triangles, in S(T).
BARS = {
    "numba": {1000: 1.6, 10_000: 1.35, 50_000: 1.35},
    "numpy": {1000: 2.6, 10_000: 1.8, 50_000: 1.8},
}
# Bar of an iteration with mid-edge normals, in iterations with hinges.
MIDEDGE_BAR = 3.0


def cholesky(stepper: Stepper, start: State) -> Callable[[], object]:
    """S(T): factorise and solve with the matrix of the next step."""
    pattern = stepper.system.pattern
    stage = stepper.integrator.stage(0, start, start, DT)
    values = stepper.system.linearize(stage, stage.predictor, start.frames).values[: pattern.nnz].copy()
    factors, rhs = PardisoFactors(POSITIVE_DEFINITE, pattern), np.ones(pattern.m)

    def action() -> None:
        if not factors.factorize(values):
            raise RuntimeError("the matrix of the scene is not positive definite")
        factors.solve(rhs)

    action()  # the analysis
    return action


class SameSteps:
    """Yardstick of other bending models: the steps of the sheet with hinges."""

    def __init__(self, triangles: int, kernels: str, steps: int) -> None:
        simulation = sheet(triangles, bending="hinge", kernels=kernels, dt=DT, t_end=1.0)
        self._stepper = stepper_of(simulation)
        rest = self._stepper.prepare(self._stepper.rest_state())
        self._start, _ = advance(self._stepper, rest, DT, 10)
        self._steps = steps
        self.iterations = advance(self._stepper, self._start, DT, steps)[1]

    def __call__(self, stepper: Stepper, start: State) -> Callable[[], object]:
        return lambda: advance(self._stepper, self._start, DT, self._steps)


@dataclass(frozen=True, slots=True)
class Aside:
    """CPU times of what no iteration repeats [s].

    Attributes:
        binding: Pattern of the matrix and the places of all terms in it, once per topology.
        analysis: Ordering and symbolic factorisation, once per topology.
        writing: A frame of positions and state to HDF5.
    """

    binding: float
    analysis: float
    writing: float


class Kept(Nowhere):
    """A sink that keeps its last frame."""

    def frame(self, frame: Frame) -> None:
        self.last = frame


def beside(simulation: Simulation, *, seconds: float) -> Aside:
    """Times of a scene at rest; the analysis is what a first factorisation takes more than a second."""
    stepper = stepper_of(simulation)
    rest = stepper.prepare(stepper.rest_state())
    pattern, free = stepper.system.pattern, np.zeros(simulation.model.dofs.n, dtype=bool)
    free[pattern.free] = True
    stage = stepper.integrator.stage(0, rest, rest, DT)
    values = stepper.system.linearize(stage, rest.q, rest.frames).values.copy()
    solver = stepper.system.solver
    solver.factorize(values)

    def first() -> None:
        LINEAR_SOLVERS[solver.name](pattern).factorize(values)

    kept = Kept()
    run(simulation, kept, limits=Limits(until=0.0))
    with tempfile.TemporaryDirectory() as folder:
        writer = make_writer("hdf5", Path(folder))
        writer.open(simulation.topology, {})
        actions = [
            lambda: System(simulation.model, free),
            first,
            lambda: solver.factorize(values),
            lambda: writer.write(kept.last),
        ]
        turns = in_turns(actions, seconds=seconds)
        writer.close()
    analysis = float(np.median(turns[:, 1] - turns[:, 2]))
    return Aside(float(turns[:, 0].min()), analysis, float(turns[:, 3].min()))


def resident_peak() -> int:
    """Most memory that this process has held [KiB]; Linux only."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))


def peak_memory(triangles: int, bending: str) -> tuple[float, float]:
    """Most memory [MiB] of a process that builds the sheet and takes a step, and before it builds."""
    # not getrusage: a child starts with the peak of its parent there
    code = (
        "from benchmarks.shells import resident_peak, stepper_of, sheet, DT\n"
        "import dismech_cli.kernels.numba_driver, pypardiso, numba\n"
        "before = resident_peak()\n"
        f"s = stepper_of(sheet({triangles}, bending='{bending}', kernels='numba', dt=DT, t_end=1.0))\n"
        "s.step(s.prepare(s.rest_state()), DT)\n"
        "print(before, resident_peak())\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).resolve().parents[1],
        capture_output=True,
        text=True,
        check=True,
    )
    before, peak = (int(word) / 1024.0 for word in done.stdout.split())
    return peak, before


def one_iteration(triangles: int, kernels: str, bending: str, quick: bool) -> tuple[Iteration, str]:
    """Times of an iteration, and its ratio beside its bar."""
    simulation = sheet(triangles, bending=bending, kernels=kernels, dt=DT, t_end=1.0)
    steps = 5 if triangles < 5000 else 1
    seconds = 1.0 if quick else 5.0
    if bending == "hinge":
        one = measure(simulation, cholesky, steps=steps, seconds=seconds)
        return one, f"{verdict(one.ratio, BARS[kernels][triangles])} S(T)"
    hinges = SameSteps(triangles, kernels, steps)
    one = measure(simulation, hinges, steps=steps, seconds=seconds)
    ratio = one.ratio * hinges.iterations
    text = verdict(ratio, MIDEDGE_BAR) if bending == "midedge" else f"{ratio:.2f}"
    return one, f"{text} x hinge"


def report(quick: bool) -> str:
    """Ratios with their bars, the split, what is beside it, exponents, and memory."""
    sizes = list(BARS["numba"])[: 2 if quick else None]
    ratios, splits, asides, growth, memory = [], [], [], [], []
    for kernels, models in MODELS.items():
        for bending in models:
            grown = []
            for triangles in sizes:
                print(f"  {kernels} {triangles} {bending}", flush=True)
                one, ratio = one_iteration(triangles, kernels, bending, quick)
                ratios.append(
                    (
                        kernels,
                        triangles,
                        bending,
                        1e3 * one.total,
                        ratio,
                        one.per_step,
                        1e3 * one.total * one.per_step,
                    )
                )
                splits.append(((kernels, triangles, bending), one))
                simulation = sheet(triangles, bending=bending, kernels=kernels, dt=DT, t_end=1.0)
                aside = beside(simulation, seconds=1.0 if quick else 5.0)
                costs = (aside.binding, aside.analysis, aside.writing)
                asides.append((kernels, triangles, bending, *[1e3 * cost for cost in costs]))
                counted = (one.total, *[one.parts[part] for part in ("terms", "factorise", "solve")], *costs)
                grown.append((len(simulation.topology.triangles), *counted))
            growth.append((kernels, bending, *_exponents(grown)))
    for triangles in sizes:
        for bending in BENDING:
            peak, before = peak_memory(triangles, bending)
            memory.append((triangles, bending, round(peak), round(peak - before)))
    scene, once = ("kernels", "triangles", "bending"), ("binding", "analysis", "frame to HDF5")
    return "\n\n".join(
        (
            "## Shells\n\nOne Newton iteration, everything included: a square sheet of equilateral triangles "
            f"of 5 mm, clamped at one side, falls in steps of {1e3 * DT:g} ms (TR-BDF2); membrane "
            "of constant-strain triangles. S(T) and the steps with hinges are timed in turns with the steps; "
            "median of the ratios.",
            table((*scene, "ms", "ratio", "iterations per step", "ms per step"), ratios),
            split_table(scene, splits),
            "Beside the iterations [ms]. Once per topology: binding makes the pattern of the matrix and "
            "finds the place of every term in it; analysis is ordering and symbolic factorisation, measured "
            "as what a first factorisation takes more than a second. Once per frame: positions, q and v "
            "appended to the run file without further fields (CPU time, without the disk's):",
            table((*scene, *once), asides),
            f"Exponents of these times in the number of triangles, fitted from {sizes[0]} to {sizes[-1]} "
            "(1 is linear; factors of plane meshes are expected to take 1.5 at best):",
            table(("kernels", "bending", "iteration", "terms", "factorise", "solve", *once), growth),
            "Peak memory [MiB] of a process that builds the sheet and takes a step with compiled kernels; "
            "the second column is what the scene adds to Python with its libraries:",
            table(("triangles", "bending", "peak", "of the scene"), memory),
        )
    )


def _exponents(grown: Sequence[tuple[float, ...]]) -> list[float]:
    """Exponents of every column of times in the first, the size."""
    triangles, *columns = zip(*grown, strict=True)
    return [exponent(triangles, times) for times in columns]
