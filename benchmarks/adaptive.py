"""Adaptive steps against fixed ones at equal error, in Newton iterations."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Final

import numpy as np

from dismech_cli.run.interrupt import StopRequest
from dismech_cli.scenario.language.study import Measured
from dismech_cli.studies.study.errors import Yardstick
from dismech_cli.studies.study.measure import Point, measure
from dismech_cli.studies.sweep.points import Base

from .table import table

ROOT: Final = Path(__file__).parents[1]
# file, overrides, quantity, steps of fixed runs and of the reference [ms], tolerances
SCENES: Final[dict[str, tuple[str, tuple[str, ...], str, Sequence[float], float, Sequence[float]]]] = {
    "swing": (
        "scenarios/cantilever_dynamic_1e5.yaml",
        ("motions[0].at=node", "numerics.t_end=1 s"),
        "tip",
        (25.0, 12.5, 6.25, 3.125, 1.5625),
        0.4,
        (1e-2, 1e-3, 3e-4, 1e-4),
    ),
    "coil": (
        "scenarios/helix_soft.yaml",
        ("numerics.t_end=0.6 s",),
        "tip",
        (20.0, 10.0, 5.0, 2.5),
        0.6,
        (1e-2, 1e-3, 3e-4),
    ),
    "twitch": (
        "tests/data/twitch.yaml",
        (),
        "tip",
        (40.0, 20.0, 10.0, 5.0, 2.5),
        0.5,
        (1e-2, 3e-3, 1e-3, 3e-4),
    ),
    "jellyfish": (
        "scenarios/jellyfish.yaml",
        ("numerics.t_end=1 s",),
        "shape",
        (8.0, 4.0, 2.0, 1.0),
        0.5,
        (1e-2, 3e-3, 1e-3, 3e-4),
    ),
}
INTEGRATORS: Final = ("tr_bdf2", "generalized_alpha")


def report(quick: bool) -> str:
    """The table of all scenes; of one with ``quick``."""
    rows = [row for name in (("twitch",) if quick else SCENES) for row in compared(name, INTEGRATORS)]
    head = ("scene", "integrator", "rtol", "error", "iterations", "of fixed steps at equal error")
    return "## Adaptive steps\n\n" + table(head, rows)


def compared(name: str, integrators: Sequence[str]) -> list[tuple[str, ...]]:
    """Rows of a scene."""
    file, overrides, probe, steps, finest, tolerances = SCENES[name]
    quantities = {"q": Measured(probe=probe, norm="rms")}
    every = ("expect={}", *(() if probe == "shape" else ("output.every=0.5 s",)))

    def ran(*more: str) -> Point:
        base = Base(path=ROOT / file, overrides=(*overrides, *every, *more))
        return measure(base, (), quantities, inf, StopRequest())

    rows = []
    right = ran("numerics.integrator={type: tr_bdf2}", f"numerics.dt={finest} ms")
    yardstick = Yardstick(quantities, right.t_end)
    yardstick.start(right.courses)
    for integrator in integrators:
        kind = f"numerics.integrator={{type: {integrator}}}"
        fixed = [ran(kind, f"numerics.dt={dt} ms") for dt in steps]
        known = sorted(
            (yardstick.distance(one.courses, right.courses), one.iterations) for one in fixed if one.stable
        )
        for rtol in tolerances:
            step = f"numerics.step={{adaptive: true, rtol: {rtol}}}"
            one = ran(kind, "numerics.dt=null", step)
            error = yardstick.distance(one.courses, right.courses)
            equal = np.exp(np.interp(np.log(error), *np.log(np.array(known)).T))
            inside = known[0][0] <= error <= known[-1][0]
            ratio = f"{one.iterations / equal:.2f}" if inside else f"({one.iterations / equal:.2f})"
            rows.append((name, integrator, f"{rtol:g}", f"{error:.2g}", str(one.iterations), ratio))
    return rows


def main(names: Sequence[str]) -> None:
    """Print rows of scenes: ``python -m benchmarks adaptive [SCENE[:INTEGRATOR] ...]``."""
    for name in names or SCENES:
        scene, _, integrator = name.partition(":")
        for row in compared(scene, (integrator,) if integrator else INTEGRATORS):
            print(*row, sep="  ", flush=True)
