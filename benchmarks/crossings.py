"""Shipped scenes of contact, seen by an oracle: how deep bodies are in each other, and what passed through.

python -m benchmarks crossings [NAME ...]      looks at scenes: benchmarks/results/crossings.md

Scenes are run with a frame at each step. The oracle shares no code with what finds contact: it measures all
pairs whose boxes overlap, and looks for what passed between two frames by roots of cubics.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import dismech_cli
from dismech_cli.scenario.language.contact import BarrierLaw, CompatLaw, PenaltyLaw

from .oracle.depths import Depths
from .oracle.passing import passed
from .table import table

SCENARIOS: Final = Path(__file__).parents[1] / "scenarios"
KEPT: Final = Path(__file__).with_name("results") / "crossings.json"
PAGE: Final = KEPT.with_suffix(".md")
# What is deeper than that is told where no tolerance is asked for.
_DOUBTFUL: Final = 0.2
# Distances are measured to rounding.
ROUNDING: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Seen:
    """A scene, as the oracle saw it; depths are shares of the thickness.

    Attributes:
        frames: How many, one at each step.
        deepest: Penetration of all frames; below zero where nothing touched.
        told: That which the run tells, at the end of any step.
        allowed: What is asked for: the tolerance, nothing within the stop of a barrier, what is doubtful
            where a stiffness is given; None with the family's law, which is there for its data.
        passed: What passed through something: times [s] and nodes.
        seconds: Wall time, of the run and of the oracle.
    """

    frames: int
    deepest: float
    told: float
    allowed: float | None
    passed: list[tuple[float, list[int]]]
    seconds: tuple[float, float]

    @property
    def sound(self) -> bool:
        """Whether all is as asked for."""
        return not self.passed and (self.allowed is None or self.deepest <= self.allowed + ROUNDING)


def scenes() -> list[Path]:
    """Those that say what touches what, themselves or by what they are made from."""
    files = sorted([*SCENARIOS.glob("*.yaml"), *(SCENARIOS / "verification").glob("*.yaml")])
    return [file for file in files if dismech_cli.load(file).scenario.contact is not None]


def seen(file: Path) -> Seen:
    """Run a scene and look at it.

    Raises:
        SolverError: It gave up.
    """
    spec = dismech_cli.load(file).scenario
    assert spec.contact is not None
    stop, allowed = _asked(spec.contact.law)
    start = time.perf_counter()
    report = dismech_cli.simulate(file, overrides=[f"output.every={spec.numerics.dt} s", "expect={}"])
    report.raise_for_status()
    ran = time.perf_counter()
    depths = Depths(report, stop)
    deepest = max(depths.deepest(frame.t, frame.positions) for frame in report.frames)
    through = passed(report)
    told = report.outcome.penetration
    return Seen(
        frames=len(report.frames),
        deepest=deepest,
        told=0.0 if told is None else told.share,
        allowed=allowed,
        passed=through,
        seconds=(ran - start, time.perf_counter() - ran),
    )


def _asked(law: PenaltyLaw | BarrierLaw | CompatLaw) -> tuple[float, float | None]:
    """Distance to keep, as a share of that at which surfaces touch, and what may be missed of it."""
    match law:
        case BarrierLaw(stop=stop):
            return stop, 0.0
        case PenaltyLaw(allowed=float() as allowed):
            return 1.0, allowed
        case PenaltyLaw():
            return 1.0, _DOUBTFUL
        case CompatLaw():
            return 1.0, None


def page(kept: dict[str, dict[str, Any]]) -> str:
    """The table of all scenes that were looked at."""
    head = ["scene", "frames", "deepest", "told by the run", "asked for", "passed through"]
    rows = []
    for name, one in sorted(kept.items()):
        shares = [_percent(one[key]) for key in ("deepest", "told", "allowed")]
        rows.append([name, one["frames"], *shares, len(one["passed"]) or "nothing"])
    return (
        "# Penetration of shipped scenes\n\n"
        "Written by `python -m benchmarks crossings`: at every step, as shares of the thickness, by\n"
        "distances and signs of volumes that share no code with what finds contact. A barrier asks that\n"
        "nothing comes within its stop; where a stiffness is given 20 % is what a run would warn of;\n"
        "data of others ask for none.\n\n"
        f"{table(head, rows)}\n"
    )


def _percent(share: float | None) -> str:
    return "none" if share is None else f"{100.0 * share:.2f} %"


def main(names: Sequence[str]) -> None:
    """Look at scenes, all without names; exit status 1 if any is not sound."""
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    bad = []
    for file in scenes():
        if names and file.stem not in names:
            continue
        one = seen(file)
        kept[file.stem] = asdict(one)
        KEPT.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        PAGE.write_text(page(kept), encoding="utf-8")
        print(file.stem, asdict(one), flush=True)
        if not one.sound:
            bad.append(file.stem)
    if bad:
        raise SystemExit(f"not as asked for: {', '.join(bad)}")
