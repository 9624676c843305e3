"""Adaptive steps against fixed ones at equal error, in Newton iterations.

python -m benchmarks adaptive [SCENE[:INTEGRATOR] ...]      measures, and writes the table of docs/trade.md
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from math import inf
from pathlib import Path
from typing import Final

import numpy as np

from dismech_cli.run.interrupt import StopRequest
from dismech_cli.scenario.language.study import Measured
from dismech_cli.studies.study.measure import Point, measure
from dismech_cli.studies.study.yardstick import Yardstick
from dismech_cli.studies.sweep.points import Base

from .table import table

ROOT: Final = Path(__file__).parents[1]
PAGE: Final = ROOT / "docs" / "trade.md"
KEPT: Final = Path(__file__).with_name("results") / "adaptive.json"
BEGIN, END = "<!-- python -m benchmarks adaptive -->", "<!-- end -->"
INTEGRATORS: Final = ("tr_bdf2", "generalized_alpha")


@dataclass(frozen=True, slots=True)
class Scene:
    """A run that is made with steps of both kinds.

    Attributes:
        title: What it is.
        file: Scenario.
        changes: What is set in it.
        quantity: Whose error counts.
        steps: Of the fixed runs [ms].
        finest: Step of the run that counts as right [ms].
        tolerances: Of the adaptive runs.
        bar: Most iterations of adaptive steps, over those of fixed ones.
    """

    title: str
    file: str
    changes: tuple[str, ...]
    quantity: str
    steps: tuple[float, ...]
    finest: float
    tolerances: tuple[float, ...]
    bar: float


SCENES: Final = {
    "swing": Scene(
        "swing of a soft cantilever, 1 s",
        "scenarios/cantilever_dynamic_1e5.yaml",
        ("motions[0].at=node", "numerics.t_end=1 s"),
        "tip",
        (25.0, 12.5, 6.25, 3.125, 1.5625),
        0.4,
        (1e-2, 1e-3, 3e-4, 1e-4),
        1.1,
    ),
    "coil": Scene(
        "swing of a soft helix, 0.6 s",
        "scenarios/helix_soft.yaml",
        ("numerics.t_end=0.6 s",),
        "tip",
        (20.0, 10.0, 5.0, 2.5),
        0.6,
        (1e-2, 1e-3, 3e-4),
        1.1,
    ),
    "twitch": Scene(
        "twitch of an arm in thick water, 3 s",
        "tests/data/twitch.yaml",
        (),
        "tip",
        (40.0, 20.0, 10.0, 5.0, 2.5),
        0.5,
        (1e-2, 3e-3, 1e-3, 3e-4),
        0.85,
    ),
    "jellyfish": Scene(
        "two beats of a jellyfish, 1 s",
        "scenarios/jellyfish.yaml",
        ("numerics.t_end=1 s",),
        "shape",
        (8.0, 4.0, 2.0, 1.0),
        0.5,
        (1e-2, 3e-3, 1e-3, 3e-4),
        0.85,
    ),
}


@dataclass(frozen=True, slots=True)
class Compared:
    """An adaptive run beside the fixed one that has its error.

    Attributes:
        rtol: Its tolerance.
        error: Root mean square over time, as a share of the range.
        iterations: Of Newton's method.
        ratio: These over those of fixed steps, whose iterations are interpolated at equal error.
        inside: Whether its error is between those of the fixed runs.
    """

    rtol: float
    error: float
    iterations: int
    ratio: float
    inside: bool


def compared(scene: Scene, integrators: Sequence[str]) -> Iterator[tuple[str, list[Compared]]]:
    """Adaptive runs of a scene, by integrator; one for each tolerance."""
    quantities = {"q": Measured(probe=scene.quantity, norm="rms")}
    every = ("expect={}", *(() if scene.quantity == "shape" else ("output.every=0.5 s",)))

    def ran(*more: str) -> Point:
        base = Base(path=ROOT / scene.file, overrides=(*scene.changes, *every, *more))
        return measure(base, (), quantities, inf, StopRequest())

    right = ran("numerics.integrator={type: tr_bdf2}", f"numerics.dt={scene.finest} ms")
    yardstick = Yardstick(quantities, right.t_end)
    yardstick.start(right.courses)

    def error(one: Point) -> float:
        return yardstick.gap(one.courses, right.courses).size

    for integrator in integrators:
        kind = f"numerics.integrator={{type: {integrator}}}"
        fixed = [ran(kind, f"numerics.dt={dt} ms") for dt in scene.steps]
        known = sorted((error(one), one.iterations) for one in fixed if one.stable)
        rows = []
        for rtol in scene.tolerances:
            one = ran(kind, "numerics.dt=null", f"numerics.step={{adaptive: true, rtol: {rtol}}}")
            share = error(one)
            equal = float(np.exp(np.interp(np.log(share), *np.log(np.array(known)).T)))
            inside = known[0][0] <= share <= known[-1][0]
            rows.append(Compared(rtol, share, one.iterations, one.iterations / equal, inside))
        yield integrator, rows


def read() -> dict[str, list[Compared]]:
    """What was measured, by scene and integrator."""
    if not KEPT.exists():
        return {}
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    return {name: [Compared(**one) for one in rows] for name, rows in kept.items()}


def told(measured: dict[str, list[Compared]]) -> str:
    """The table."""
    rows = []
    for name, runs in measured.items():
        scene, _, integrator = name.partition(":")
        cells = (
            ", ".join(f"{one.rtol:.0e}".replace("e-0", "e-") for one in runs),
            ", ".join(f"{100.0 * one.error:.2g}" for one in runs) + " %",
            ", ".join(str(one.iterations) for one in runs),
            ", ".join(f"{one.ratio:.2f}" if one.inside else f"({one.ratio:.2f})" for one in runs),
        )
        rows.append((SCENES[scene].title, f"`{integrator}`", *cells, str(SCENES[scene].bar)))
    return table(("scene", "integrator", "`rtol`", "error", "iterations", "of fixed steps", "bar"), rows)


def main(names: Sequence[str]) -> None:
    """Measure scenes, keep what came of them, and write the table."""
    measured = read()
    order = [f"{scene}:{integrator}" for scene in SCENES for integrator in INTEGRATORS]
    for asked in names or SCENES:
        scene, _, one = asked.partition(":")
        for integrator, rows in compared(SCENES[scene], (one,) if one else INTEGRATORS):
            measured[f"{scene}:{integrator}"] = rows
            print(
                scene, integrator, *(f"{row.rtol:g}: {row.ratio:.2f}" for row in rows), sep="  ", flush=True
            )
            measured = {name: measured[name] for name in order if name in measured}
            kept = {name: [asdict(row) for row in rows] for name, rows in measured.items()}
            KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}\n{told(measured)}\n{END}{rest.split(END, 1)[1]}", encoding="utf-8")
