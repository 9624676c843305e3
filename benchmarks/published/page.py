"""The table of benchmarks/results/published.md."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from dismech_cli.quantities import with_unit

from ..table import table
from .benchmarks import BENCHMARKS, Benchmark
from .row import Row

PAGE: Final = Path(__file__).parents[1] / "results" / "published.md"
KEPT: Final = PAGE.with_suffix(".json")

_TOP = """# Published benchmarks

What the program gives beside the numbers of the literature and of other codes. A row is an expectation of a
scenario in `scenarios/`, where its value, tolerance and source stand, or a load at which one loses its
stability, found by bisection. Nothing here is written by hand:

    python -m benchmarks published            # all; or some: python -m benchmarks published elastica plates

A scenario runs as it is shipped but for what `--set` changes, where a load was sought to the published one.
Orders of convergence, other meshes and what has no published number are on the page on
[verification](../../docs/verification.md).

"""
_HEAD: Final = ("quantity", "published", "here", "deviation", "tolerance", "met", "source")


def main(names: Sequence[str]) -> None:
    """Run benchmarks, keep what they gave, write the page; exit code 1 if one is not met."""
    if unknown := set(names) - set(BENCHMARKS):
        raise SystemExit(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(BENCHMARKS)}")
    kept = read()
    for name in names or BENCHMARKS:
        print(name, end=" ", flush=True)
        began = time.process_time()
        rows = [row for case in BENCHMARKS[name].cases for row in case.rows()]
        seconds = time.process_time() - began
        missed = [row for row in rows if not row.met]
        print(f"{len(rows)} rows, {len(missed)} missed, {seconds:.0f} CPU s", flush=True)
        kept[name] = {"seconds": round(seconds), "rows": [asdict(row) for row in rows]}
        KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        PAGE.write_text(page(kept), encoding="utf-8")
    raise SystemExit(any(not row["met"] for one in kept.values() for row in one["rows"]))


def read() -> dict[str, Any]:
    """What was kept of benchmarks that there still are."""
    if not KEPT.exists():
        return {}
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    return {name: kept[name] for name in BENCHMARKS if name in kept}


def page(kept: dict[str, Any]) -> str:
    """The page of benchmarks that were run."""
    ran = {name: [Row(**row) for row in kept[name]["rows"]] for name in BENCHMARKS if name in kept}
    every = [row for rows in ran.values() for row in rows]
    met = sum(row.met for row in every)
    seconds = sum(one["seconds"] for one in kept.values())
    sums = [
        (f"`{name}`", BENCHMARKS[name].title, str(len(rows)), str(sum(row.met for row in rows)))
        for name, rows in ran.items()
    ]
    sums.append(("all", f"in {seconds} s of CPU time", str(len(every)), str(met)))
    summary = table(("name", "benchmark", "rows", "met"), sums) + "\n"
    return "\n".join(
        [_TOP + summary, *(_section(name, BENCHMARKS[name], rows) for name, rows in ran.items())]
    )


def _section(name: str, benchmark: Benchmark, rows: Sequence[Row]) -> str:
    parts = [f"## {benchmark.title}\n", f"`python -m benchmarks published {name}` runs\n"]
    for command in dict.fromkeys(row.command for row in rows):
        parts.append(f"`{command}`\n")
        parts.append(table(_HEAD, [_cells(row) for row in rows if row.command == command]) + "\n")
    return "\n".join(parts)


def _cells(row: Row) -> tuple[str, ...]:
    published, here = (with_unit(f"{x:.6g}", row.unit) for x in (row.published, row.here))
    met = "yes" if row.met else "**no**"
    return (row.quantity, published, here, row.deviation, row.tolerance, met, row.source)
