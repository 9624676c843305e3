"""The table of docs/extremes.md."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from .cell import Kind, judged
from .families import FAMILIES, Family

PAGE: Final = Path(__file__).parents[2] / "docs" / "extremes.md"
KEPT: Final = Path(__file__).with_name("outcomes.json")

_HEAD = """# Extremes

What happens at the ends of the range of inputs: every scene below converges and is right, or the run
gives up with exit code 3 and names the reason. None ends otherwise: no wrong number without a word, no
NaN, no traceback.

    python -m benchmarks extremes            # all; or some: python -m benchmarks extremes units control

Right means: against a formula, or against the balance of forces of each frame, which is evaluated from
the nodes by formulas that share nothing with the program (`benchmarks/extremes/rod_balance.py`).

| family | what | scenes | converged and right | exit 3, named | neither | CPU |
|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a family: counts, CPU time [s], and cells that gave up or were wrong, with the reason."""

    right: int
    named: int
    wrong: int
    seconds: float
    reasons: dict[str, int]
    gave_up: list[str]


def outcome(family: Family) -> Outcome:
    """Run a family."""
    verdicts = [judged(cell) for cell in family.cells()]
    kinds = Counter(one.kind for one in verdicts)
    others = [one for one in verdicts if one.kind is not Kind.RIGHT]
    for one in others:
        print(f"{one.cell}: {one.kind.value}: {one.why}", flush=True)
    return Outcome(
        right=kinds[Kind.RIGHT],
        named=kinds[Kind.NAMED],
        wrong=kinds[Kind.WRONG],
        seconds=round(sum(one.seconds for one in verdicts), 1),
        reasons=dict(Counter(one.why for one in others)),
        gave_up=[one.cell.label for one in others],
    )


def main(names: Sequence[str]) -> None:
    """Run families, keep what came of them, write the page."""
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    for name in names or FAMILIES:
        kept[name] = asdict(outcome(FAMILIES[name]))
        KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page({name: Outcome(**one) for name, one in kept.items()}), encoding="utf-8")
    raise SystemExit(1 if any(one["wrong"] for one in kept.values()) else 0)


def page(outcomes: dict[str, Outcome]) -> str:
    """The page of families that were run."""
    rows, given_up = [], []
    for name, family in FAMILIES.items():
        if name not in outcomes:
            continue
        one = outcomes[name]
        count = one.right + one.named + one.wrong
        rows.append(
            f"| `{name}` | {family.what} | {count} | {one.right} | {one.named} | {one.wrong} | "
            f"{one.seconds:.0f} s |"
        )
        if one.reasons:
            reasons = ", ".join(f"{why} ({number})" for why, number in one.reasons.items())
            cells = "; ".join(one.gave_up) if len(one.gave_up) <= 12 else family.gives_up
            given_up.append(f"- `{name}`: {reasons}: {cells}.")
    total = [sum(getattr(one, kind) for one in outcomes.values()) for kind in ("right", "named", "wrong")]
    seconds = sum(one.seconds for one in outcomes.values())
    rows.append(f"| all | | {sum(total)} | {total[0]} | {total[1]} | {total[2]} | {seconds:.0f} s |")
    return _HEAD + "\n".join(rows) + "\n\n## What gives up\n" + "\n".join(given_up) + "\n" + _TAIL


_TAIL = """
A rod of some 4000 edges and more that bends under its weight at rest is the one limit of double precision
met here: forces between neighbours, E I / l^3, round by more than the load. Its step is told as *lost in
rounding*; in time, inertia holds each node and there is no such limit. Rods that hang by stretching are
right at any number of edges.

Generalised-alpha is left out: at steps longer than a tenth of a pendulum's period it makes energy in
falls, which the run tells at its end (`tests/extremes`). The default integrator, TR-BDF2, and implicit
Euler do not.
"""
