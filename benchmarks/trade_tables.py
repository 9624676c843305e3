"""Brute force of `dismech study`: every combination of some scenes as a table, which tests search.

python -m benchmarks trade_tables [NAME ...]            writes tests/data/trade/NAME.json, minutes each
python -m benchmarks trade_tables --between [NAME ...]  adds the runs between levels with which searches end
python -m benchmarks trade_tables --again [NAME ...]    times all twice more: the median of three counts
python -m benchmarks trade_tables --bars                what searches claim of these tables, beside the bars
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from dismech_cli.run.interrupt import StopRequest
from dismech_cli.scenario.language.study import Measured
from dismech_cli.studies.study.given_study import given_over
from dismech_cli.studies.study.measure import DONE, Point, measure
from dismech_cli.studies.study.runs import Runs
from dismech_cli.studies.study.search import find
from dismech_cli.studies.study.space import Setting, Space, make_space
from dismech_cli.studies.study.yardstick import Yardstick
from dismech_cli.studies.sweep.points import Base

from .table import table, verdict

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "tests" / "data" / "trade"
TIMES = 81
METHODS = "numerics.integrator=tr_bdf2,generalized_alpha,implicit_euler"
NODES = "geometry[0].generate.nodes"
AT_NODE = "motions[0].at=node"
NO_EXPECT = "expect={}"
TARGETS = (0.1, 0.05, 0.03, 0.02, 0.01)
QUANTITIES = {"q": Measured(probe="q")}
Run = Callable[[tuple[Setting, ...], float], Point]

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


@dataclass(frozen=True, slots=True)
class Table:
    """All runs of a scene.

    Attributes:
        space: What was tried.
        points: The run of every combination.
        between: Runs between levels.
        true: Of the quantity, at equal times.
        t_end: End of the runs [s].
    """

    space: Space
    points: dict[tuple[Setting, ...], Point]
    between: dict[tuple[Setting, ...], Point]
    true: np.ndarray
    t_end: float

    def error(self, point: Point) -> float:
        """True error of a run, as a share of the range."""
        if not point.stable:
            return inf
        return float(np.abs(point.courses["q"][1] - self.true).max() / np.ptp(self.true))

    def at(self, *key: int) -> Point:
        """Run of an alternative, level of time, level of mesh."""
        return self.points[self.space.settings(*key)]

    def cheapest_robust(self, target: float) -> float:
        """CPU of the cheapest run that meets a target with its finer neighbours; infinite if none does."""
        space, cheapest = self.space, inf
        last_time, last_mesh = len(space.time) - 1, len(space.mesh) - 1
        for m in range(len(space.methods)):
            for t in range(last_time + 1):
                for h in range(last_mesh + 1):
                    around = [(m, t, h), (m, min(t + 1, last_time), h), (m, t, min(h + 1, last_mesh))]
                    if all(self.error(self.at(*key)) <= target for key in around):
                        cheapest = min(cheapest, self.at(m, t, h).cpu)
        return cheapest


def read(file: Path) -> Table:
    """A table that was made."""
    data: dict[str, Any] = json.loads(file.read_text())
    scene, *overrides = data["base"]
    space = make_space(
        Base(path=ROOT / scene, overrides=(*overrides, NO_EXPECT)).load(), given_over(data["axes"])
    )
    true = np.array(data["true"])
    times = np.linspace(0.0, data["t_end"], len(true))

    def points(name: str) -> dict[tuple[Setting, ...], Point]:
        made = (_read_point(one, data["t_end"], times) for one in data.get(name, ()))
        return {point.settings: point for point in made}

    return Table(space, points("points"), points("between"), true, data["t_end"])


def _read_point(one: dict[str, Any], t_end: float, times: np.ndarray) -> Point:
    courses = {} if one["course"] is None else {"q": (times, np.array(one["course"]))}
    numbers = {name: one[name] for name in ("status", "cpu", "steps", "iterations", "cuts", "size", "order")}
    settings = tuple(one["settings"].items())
    return Point(settings=settings, message="", t_end=t_end, courses=courses, **numbers)


def unknown(settings: tuple[Setting, ...], price: float) -> Point:
    """A run between levels that no table has: it counts as unstable."""
    return Point(
        settings=settings, status="failed", message="", cpu=0.0, steps=0, iterations=0, cuts=0,
        size=0.0, order=2, t_end=0.0, courses={},
    )  # fmt: skip


def runs_of(table: Table, otherwise: Run = unknown) -> Runs:
    """Runs that are looked up."""
    known = table.points | table.between

    def run(settings: tuple[Setting, ...], price: float) -> Point:
        return known[settings] if settings in known else otherwise(settings, price)

    return Runs(table.space, run, Yardstick(QUANTITIES, table.t_end))


def add_between(name: str) -> None:
    """Run what searches end with between levels, and keep it with the table instead of what none asks for."""
    path = FOLDER / f"{name}.json"
    data, table = json.loads(path.read_text()), read(path)
    file, overrides, _, probe, _ = SCENES[name]
    base = Base(path=ROOT / file, overrides=(*overrides, NO_EXPECT))
    compiled = False
    between: dict[tuple[Setting, ...], Point] = {}
    used: set[tuple[Setting, ...]] = set()

    def run(settings: tuple[Setting, ...], price: float) -> Point:
        nonlocal compiled
        if settings not in between:
            if not compiled:
                measure(base, settings, {"q": Measured(probe=probe)}, inf, StopRequest())
                compiled = True
            point = measure(base, settings, {"q": Measured(probe=probe)}, price, StopRequest())
            between[settings] = replace(point, cpu=point.iterations * _iteration(table, settings))
            print(between[settings].label, f"{between[settings].cpu:.3g}", flush=True)
        return _resampled(between[settings], table)

    for target in TARGETS:
        runs = runs_of(table, run)
        find(runs, target)
        used |= {one.settings for one in runs.extra}
    earlier = [one for one in data.get("between", ()) if tuple(one["settings"].items()) in used]
    data["between"] = earlier + [_kept(one) for one in between.values()]
    path.write_text(json.dumps(data, separators=(",", ":")) + "\n")


def _iteration(table: Table, settings: tuple[Setting, ...]) -> float:
    """CPU time of an iteration [s] in the table's run that differs by its step alone, the finest such.

    The machine of another hour is another one: times are compared within a table.
    """
    rest = {pair for pair in settings if pair[0] != "numerics.dt"}
    alike = [one for one in table.points.values() if one.stable and rest <= set(one.settings)]
    longest = max(alike, key=lambda one: one.iterations)
    return longest.cpu / longest.iterations


def time_again(name: str) -> None:
    """Time every run of a table twice more: other programs make one time good to a factor of two only."""
    path = FOLDER / f"{name}.json"
    data = json.loads(path.read_text())
    file, overrides, _, probe, _ = SCENES[name]
    base = Base(path=ROOT / file, overrides=(*overrides, NO_EXPECT))
    quantities = {"q": Measured(probe=probe)}
    points = [one for one in (*data["points"], *data.get("between", ())) if one["status"] == DONE]
    measure(base, tuple(points[0]["settings"].items()), quantities, inf, StopRequest())  # compiles
    for one in points:
        settings = tuple(one["settings"].items())
        times = [measure(base, settings, quantities, inf, StopRequest()).cpu for _ in range(2)]
        one["cpu"] = round(median([one["cpu"], *times]), 5)
    path.write_text(json.dumps(data, separators=(",", ":")) + "\n")
    print(name, flush=True)


def _resampled(point: Point, table: Table) -> Point:
    times = np.linspace(0.0, table.t_end, len(table.true))
    return replace(point, courses={"q": (times, _sampled(point, table.t_end))}) if point.stable else point


def make(name: str) -> None:
    """Run everything and write the table."""
    file, overrides, axes, probe, fine = SCENES[name]
    base = Base(path=ROOT / file, overrides=(*overrides, NO_EXPECT))
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
        "points": [_kept(point) for point in points],
    }
    (FOLDER / f"{name}.json").write_text(json.dumps(table, separators=(",", ":")) + "\n")


def _kept(point: Point) -> dict[str, Any]:
    return {
        "settings": dict(point.settings),
        "status": point.status,
        "cpu": round(point.cpu, 5),
        "steps": point.steps,
        "iterations": point.iterations,
        "cuts": point.cuts,
        "size": point.size,
        "order": point.order,
        "course": _short(_sampled(point, point.t_end)) if point.stable else None,
    }


def _mesh_value(settings: tuple[Setting, ...]) -> str:
    return dict(settings)[NODES]


def _sampled(point: Point, t_end: float) -> np.ndarray:
    from scipy.interpolate import CubicSpline

    times, values = point.courses["q"]
    return CubicSpline(times, values)(np.linspace(0.0, t_end, TIMES))


def _short(values: np.ndarray) -> list[float]:
    return [float(f"{value:.7g}") for value in values]


def bars() -> str:
    """What the search finds in the tables it was made with, and in those that it was not."""
    rows = []
    for kind, names in (("made with", SCENES.keys() - HELD_OUT.keys()), ("held out", HELD_OUT.keys())):
        claims, excess, cost, runs_made, time_spent = 0, [], [], [], []
        for one in (read(FOLDER / f"{name}.json") for name in sorted(names)):
            for target in TARGETS:
                runs = runs_of(one)
                found = find(runs, target)[0]
                runs_made.append(len(runs.points) / one.space.count)
                if found.meets:
                    claims += 1
                    excess.append(one.error(found.point) / target)
                    cost.append(found.point.cpu / one.cheapest_robust(target))
                    spent = sum(point.cpu for point in runs.points.values())
                    time_spent.append(spent / sum(point.cpu for point in one.points.values()))
        rows.append(
            (
                f"{kind}, {len(names)} scenes",
                claims,
                verdict(max(excess), 1.25),
                f"{np.mean(np.array(excess) <= 1.0):.0%} (bar 90 %)",
                verdict(float(np.mean(cost)), 1.6),
                verdict(max(cost), 3.0),
                verdict(float(np.mean(runs_made)), 0.3),
                verdict(float(np.mean(time_spent)), 0.2),
            )
        )
    return table(BARS, rows)


BARS = (
    "tables",
    "claims",
    "largest error over target",
    "true",
    "price of the cheapest robust, mean",
    "at most",
    "share of all runs",
    "of their CPU time",
)


def main(names: Sequence[str]) -> None:
    """Make tables, add what lies between their levels, or tell what a search finds in them."""
    if "--bars" in names:
        print(bars())
        return
    does = {"--between": add_between, "--again": time_again}
    wanted = next((does[name] for name in names if name in does), make)
    for name in [name for name in names if name not in does] or SCENES:
        wanted(name)
