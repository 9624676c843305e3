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
        cases = {
            "dismech --help": ([*DISMECH, "--help"], 0.5, {}),
            "dismech --help, no bytecode": ([*DISMECH, "--help"], 0.5, {"cold": "yes"}),
            "dismech run cantilever.yaml": (run, 5.0, {}),
            "dismech run cantilever.yaml, no bytecode, no compiled kernels": (run, 5.0, {"cold": "yes"}),
        }
        for name, (command, bar, cold) in cases.items():
            times = []
            for index in range(repeats):
                caches = {}
                if cold:
                    empty = str(Path(folder) / f"{name[:12]}{index}")
                    caches = {"PYTHONPYCACHEPREFIX": empty, "DISMECH_CACHE": empty, "XDG_CACHE_HOME": empty}
                    caches["PYTHONDONTWRITEBYTECODE"] = "1"
                times.append(seconds(command, folder, PYTHONPATH=root, **caches))
            walls, cpus = zip(*times, strict=True)
            rows.append((name, verdict(min(walls), bar), max(walls), min(cpus)))
    return "\n\n".join(
        (
            f"## Start-up\n\nSeconds of {repeats} starts, on two cores that others used at the time:",
            table(("command", "least wall", "most wall", "least CPU"), rows),
        )
    )
