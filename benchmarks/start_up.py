"""Time from the shell's prompt to help, to a check, to the end of a short run and to its pictures."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from .scenes import SCENARIOS
from .table import table, verdict

# Where Python, that of the standard library included, and Numba keep what they compile.
CACHES = ("PYTHONPYCACHEPREFIX", "DISMECH_CACHE", "XDG_CACHE_HOME")
DISMECH = [sys.executable, "-m", "dismech_cli"]


def seconds(command: list[str], folder: str, **environment: str) -> tuple[float, float]:
    """Wall time and CPU time of a command in a folder [s]."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, cwd=folder, check=True, capture_output=True, env=os.environ | environment)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def compiled(folder: str) -> int:
    """Functions that Numba compiled into a cache."""
    return sum(1 for _ in Path(folder).rglob("*.nbc"))


def report(quick: bool) -> str:
    """Help and a run, with and without the caches of earlier starts; a row says what it compiles."""
    root = str(Path(__file__).resolve().parents[1])
    repeats = 2 if quick else 5
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scene = str(SCENARIOS / "cantilever.yaml")
        bare = [*DISMECH, "run", scene, "--no-render"]
        numba = [*bare, "--set", "numerics.kernels=numba"]

        def warm() -> str:
            return str(Path(folder) / "warm")

        def cold() -> str:
            return tempfile.mkdtemp(dir=folder)

        cases = {
            "dismech --help": ([*DISMECH, "--help"], 0.5, warm),
            "dismech --help, no bytecode": ([*DISMECH, "--help"], 0.5, cold),
            "dismech check cantilever.yaml": ([*DISMECH, "check", scene], 2.0, warm),
            "dismech run cantilever.yaml --no-render, kernels by NumPy": (bare, 5.0, warm),
            "the same run, no bytecode": (bare, 5.0, cold),
            "the same run, kernels compiled before": (numba, 5.0, warm),
            "the same run, no bytecode, kernels compiled here": (numba, 60.0, cold),
            "dismech run cantilever.yaml, with its pictures, as in the README": (
                [*DISMECH, "run", scene],
                30.0,
                warm,
            ),
            "the same, no bytecode: the first command after the installation": (
                [*DISMECH, "run", scene],
                30.0,
                cold,
            ),
        }
        for name, (command, bar, place) in cases.items():
            times, made = [], 0
            # one more, not counted: it fills the caches, where there are any, and those of the disk
            for _ in range(repeats + 1):
                caches = place()
                before = compiled(caches)
                writing = "" if place is warm else "1"
                environment = dict.fromkeys(CACHES, caches) | {"PYTHONDONTWRITEBYTECODE": writing}
                times.append(seconds(command, folder, PYTHONPATH=root, **environment))
                made = compiled(caches) - before
            walls, cpus = zip(*times[1:], strict=True)
            rows.append((name, verdict(min(cpus), bar), min(walls), max(walls), str(made)))
    return "\n\n".join(
        (
            f"## Start-up\n\nSeconds of {repeats} starts, on two cores that others used at the time:",
            table(("command", "least CPU", "least wall", "most wall", "functions compiled"), rows),
        )
    )
