"""Wall time from the shell's prompt to help, and to the end of a short run."""

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


def report(quick: bool) -> str:
    """Help and a run, with and without the caches of earlier starts."""
    root = str(Path(__file__).resolve().parents[1])
    repeats = 2 if quick else 5
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        run = [*DISMECH, "run", str(SCENARIOS / "cantilever.yaml"), "--set", "output.render={}"]

        def warm() -> dict[str, str]:
            return dict.fromkeys(CACHES, folder) | {"PYTHONDONTWRITEBYTECODE": ""}

        def cold() -> dict[str, str]:
            empty = tempfile.mkdtemp(dir=folder)
            return dict.fromkeys(CACHES, empty) | {"PYTHONDONTWRITEBYTECODE": "1"}

        cases = {
            "dismech --help": ([*DISMECH, "--help"], 0.5, warm),
            "dismech --help, no bytecode": ([*DISMECH, "--help"], 0.5, cold),
            "dismech run cantilever.yaml": (run, 5.0, warm),
            "dismech run cantilever.yaml, no bytecode, no compiled kernels": (run, 5.0, cold),
        }
        for name, (command, bar, caches) in cases.items():
            # one more, not counted: it fills the caches, where there are any, and those of the disk
            times = [seconds(command, folder, PYTHONPATH=root, **caches()) for _ in range(repeats + 1)][1:]
            walls, cpus = zip(*times, strict=True)
            rows.append((name, verdict(min(walls), bar), max(walls), min(cpus)))
    return "\n\n".join(
        (
            f"## Start-up\n\nSeconds of {repeats} starts, on two cores that others used at the time:",
            table(("command", "least wall", "most wall", "least CPU"), rows),
        )
    )
