"""Brute force of `dismech study`: every combination of some scenes as a table, which tests search.

python benchmarks/trade_tables.py [NAME ...]     writes tests/data/trade/NAME.json, minutes each
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from dismech_cli.run.interrupt import StopRequest
from dismech_cli.scenario.language.study import Measured
from dismech_cli.studies.study.given_study import given_over
from dismech_cli.studies.study.measure import Point, measure
from dismech_cli.studies.study.space import Setting, make_space
from dismech_cli.studies.sweep.points import Base

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "tests" / "data" / "trade"
TIMES = 81
METHODS = "numerics.integrator=tr_bdf2,generalized_alpha,implicit_euler"
NODES = "geometry[0].generate.nodes"
AT_NODE = "motions[0].at=node"

SCENES: dict[str, tuple[str, tuple[str, ...], tuple[str, ...], str, str]] = {
    # file, overrides, axes, probe, finer step and mesh of the reference
    "soft_cantilever": (
        "scenarios/cantilever_dynamic_1e5.yaml",
        (AT_NODE, "numerics.t_end=0.4 s"),
        ("numerics.dt=12.5 ms:5", f"{NODES}=11:4"),
        "tip",
        "0.4 ms",
    ),
    "stiff_cantilever": (
        "scenarios/cantilever_dynamic_1e6.yaml",
        (AT_NODE, "numerics.t_end=0.15 s"),
        ("numerics.dt=5 ms:5", f"{NODES}=11:4"),
        "tip",
        "0.15 ms",
    ),
    "helix_soft": (
        "scenarios/helix_soft.yaml",
        ("numerics.t_end=0.4 s",),
        ("numerics.dt=20 ms:5", f"{NODES}=26:3"),
        "tip",
        "0.6 ms",
    ),
    "snake_21": (
        "scenarios/snake_21.yaml",
        ("numerics.t_end=1 s",),
        ("numerics.dt=50 ms:5", f"{NODES}=11:3"),
        "mean_x",
        "1.5 ms",
    ),
    "twitch": (
        "tests/data/twitch.yaml",
        ("numerics.t_end=1 s",),
        ("numerics.dt=40 ms:5", f"{NODES}=11:3"),
        "tip",
        "1 ms",
    ),
}
# Not looked at while the search was made: they tell whether it is tuned to the others.
HELD_OUT = {
    "measured_arm": (
        "scenarios/measured_arm.yaml",
        ("numerics.t_end=0.6 s",),
        ("numerics.dt=20 ms:5", f"{NODES}=11:3"),
        "tip_z",
        "0.5 ms",
    ),
    "boundary_motion": (
        "scenarios/boundary_motion.yaml",
        ("numerics.t_end=2 s",),
        ("numerics.dt=40 ms:5", f"{NODES}=26:3"),
        "tip_x",
        "1 ms",
    ),
    "bouncing_weight": (
        "scenarios/bouncing_weight.yaml",
        ("output.probes={low: {position: cord.end, component: z}}",),
        ("numerics.dt=16 ms:5", f"{NODES}=6:3"),
        "low",
        "0.5 ms",
    ),
    "sinking_arc": (
        "scenarios/sinking_arc.yaml",
        ("output.probes={down: {displacement: bow.end, component: z}}", "numerics.t_end=0.4 s"),
        ("numerics.dt=40 ms:5", f"{NODES}=21:3"),
        "down",
        "1 ms",
    ),
}
SCENES |= HELD_OUT


def make(name: str) -> None:
    """Run everything and write the table."""
    file, overrides, axes, probe, fine = SCENES[name]
    base = Base(path=ROOT / file, overrides=(*overrides, "expect={}"))
    quantities = {"q": Measured(probe=probe)}
    space = make_space(base.load(), given_over((*axes, METHODS)))

    def run(settings: tuple[Setting, ...], price: float) -> Point:
        point = measure(base, settings, quantities, price, StopRequest())
        print(point.label, point.status, f"{point.cpu:.3g}", flush=True)
        return point

    run(space.settings(0, 0, 0), float("inf"))  # compiles
    points, price = [], float("inf")
    for method in range(len(space.methods)):
        for mesh in range(len(space.mesh)):
            for time in range(len(space.time)):
                point = run(space.settings(method, time, mesh), price)
                if point.stable:
                    price = min(price, point.cpu / point.size)
                points.append(point)
    last = len(space.mesh) - 1
    finest = space.settings(0, 0, last)
    (coarse, finer) = (_mesh_value(space.settings(0, 0, mesh)) for mesh in (last - 1, last))
    next_mesh = str(int(finer) + (int(finer) - int(coarse)) * 2)
    references = []
    for nodes in (finer, next_mesh):
        changed = tuple(
            (key, fine if key == "numerics.dt" else nodes if key == NODES else text) for key, text in finest
        )
        references.append(run(changed, float("inf")))
    t_end = points[0].t_end
    a, b = (_sampled(point, t_end) for point in references)
    FOLDER.mkdir(parents=True, exist_ok=True)
    table = {
        "t_end": t_end,
        "axes": [*axes, METHODS],
        "base": [file, *overrides],
        "probe": probe,
        "true": _short(b + (b - a) / 3.0),
        "mesh_left": float(np.abs(b - a).max() / 3.0 / np.ptp(b)),
        "points": [
            {
                "settings": dict(point.settings),
                "status": point.status,
                "cpu": round(point.cpu, 5),
                "steps": point.steps,
                "iterations": point.iterations,
                "cuts": point.cuts,
                "size": point.size,
                "order": point.order,
                "course": _short(_sampled(point, t_end)) if point.stable else None,
            }
            for point in points
        ],
    }
    (FOLDER / f"{name}.json").write_text(json.dumps(table, separators=(",", ":")) + "\n")


def _mesh_value(settings: tuple[Setting, ...]) -> str:
    return dict(settings)[NODES]


def _sampled(point: Point, t_end: float) -> np.ndarray:
    from scipy.interpolate import CubicSpline

    times, values = point.courses["q"]
    return CubicSpline(times, values)(np.linspace(0.0, t_end, TIMES))


def _short(values: np.ndarray) -> list[float]:
    return [float(f"{value:.7g}") for value in values]


if __name__ == "__main__":
    for wanted in sys.argv[1:] or SCENES:
        make(wanted)
