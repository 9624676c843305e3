"""Run all benchmarks and write RESULTS.md: ``python -m benchmarks [--quick] [section ...]``.

Each section is written to results/<section>.md as soon as it is measured, and RESULTS.md joins
them: a single section can be repeated without the others.

Other names (``TABLES``) measure no time of a section: they write tables of their own, as their files tell.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

SECTIONS = (
    "newton_iteration",
    "growth",
    "shells",
    "projection",
    "bending",
    "run_loop",
    "linear_solvers",
    "overlay",
    "contact",
    "integrators",
    "defaults",
    "other_code",
    "gradients",
    "start_up",
    "drawing",
    "memory",
)
TABLES = (
    "adaptive",
    "before",
    "check_times",
    "crossings",
    "extremes",
    "published",
    "scene_trade",
    "trade_tables",
)
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
HERE = Path(__file__).resolve().parent


def main() -> None:
    """Measure the sections asked for, and join the table; or make another table."""
    # read when NumPy, MKL and Numba are first imported, which sections and tables do
    os.environ.update(dict.fromkeys(THREADS, "1"))
    if sys.argv[1:2] and sys.argv[1] in TABLES:
        import_module(f"benchmarks.{sys.argv[1]}").main(sys.argv[2:])
        return
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", metavar="section", help=", ".join(SECTIONS))
    parser.add_argument("--quick", action="store_true", help="fewer repetitions")
    arguments = parser.parse_args()
    unknown = set(arguments.sections) - set(SECTIONS)
    if unknown:
        parser.error(f"no section {', '.join(sorted(unknown))}; there are {', '.join(SECTIONS)}")
    parts = HERE / "results"
    parts.mkdir(exist_ok=True)
    for name in arguments.sections or SECTIONS:
        print(f"measuring {name}", flush=True)
        text = import_module(f"benchmarks.{name}").report(arguments.quick)
        (parts / f"{name}.md").write_text(text + "\n", encoding="utf-8")
    written = [parts / f"{name}.md" for name in SECTIONS]
    body = [path.read_text(encoding="utf-8") for path in written if path.exists()]
    (HERE / "RESULTS.md").write_text("\n".join([_heading(), *body]), encoding="utf-8")


def _heading() -> str:
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba"))
    return (
        "# Timings\n\nWritten by `python -m benchmarks`. CPU time of one thread, the least of repeated runs, "
        f"on {_processor()} with Python {platform.python_version()}, {versions}. Other programs ran on "
        "the same machine: compare ratios, whose two sides were timed in turns.\n"
    )


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


if __name__ == "__main__":
    main()
