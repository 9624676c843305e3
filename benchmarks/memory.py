"""Peak memory of short runs of every shipped scene, and of larger ones, over what ``check`` says."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from .scenes import SCENARIOS
from .table import table

BAR = 1.5  # largest factor between the estimate and the peak, either way
# The high-water mark of the process itself: that of getrusage takes in whoever started it.
PROGRAM = """
import os, sys
from pathlib import Path
from dismech_cli.cli.app import app
from dismech_cli.cli.exits import exit_code
code = exit_code(app, sys.argv[1:])
(line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
print(f"peak {code} {line.split()[1]}", file=sys.stderr, flush=True)
os._exit(0)
"""
_LINE = {"shape": "line", "from": [0, 0, 0]}
_HELIX = {"shape": "helix", "origin": [0, 0, 0], "axis": [0, 0, 1], "radius": 0.1, "pitch": 0.02}


def called(folder: Path, *arguments: str) -> tuple[str, float]:
    """Standard output of the program, and the peak of its memory [byte]; Linux only."""
    environment = os.environ | {"PYTHONPATH": str(SCENARIOS.parent)}
    command = [sys.executable, "-c", PROGRAM, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=True)
    last = done.stderr.splitlines()[-1].split()
    assert int(last[1]) in (0, 3, 4, 130), done.stderr
    return done.stdout, 1024.0 * float(last[2])


def compared(scene: Path, seconds: str = "3s") -> tuple[str, float, float]:
    """Kernels and solver of a scene, what ``check`` estimates and the peak of its first seconds [byte]."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (checked,) = json.loads(called(folder, "check", str(scene), "--json")[0])
        options = ("--wall-limit", seconds, "--no-render", "-q", "--progress", "none")
        _, peak = called(folder, "run", str(scene), "-o", "out", *options)
    (kernels,) = (word for d in checked["plan"] for word in ("numpy", "numba") if d["what"].endswith(word))
    return f"{kernels}, {checked['cost']['solver']}", checked["cost"]["memory"], peak


def shipped() -> list[Path]:
    """Every shipped scene."""
    return [*sorted(SCENARIOS.glob("*.yaml")), *sorted((SCENARIOS / "verification").glob("*.yaml"))]


def report(quick: bool) -> str:
    """Every shipped scene, then larger ones."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for scene in (*shipped(), *(() if quick else _larger(Path(folder)))):
            parts, estimate, peak = compared(scene)
            factor = max(estimate / peak, peak / estimate)
            rows.append(
                (scene.stem, parts, peak / 1e6, estimate / 1e6, f"{estimate / peak:.2f}", factor <= BAR)
            )
    met = sum(row[-1] for row in rows)
    return "\n\n".join(
        (
            "## Memory\n\nPeak of a run of three seconds and the estimate of `check` [MB], pictures aside, "
            f"which another process draws: {met} of {len(rows)} within a factor of {BAR:g}.",
            table(("scene", "kernels, solver", "peak", "estimate", "ratio"), [row[:-1] for row in rows]),
        )
    )


def _larger(folder: Path) -> Iterator[Path]:
    for kernels in ("numpy", "numba"):
        line = _LINE | {"to": [60, 0, 0], "nodes": 30_000}
        yield _written(folder, f"line_30000_{kernels}", _rod(line), kernels, dimension=2)
        helix = _HELIX | {"turns": 300, "handedness": "right", "nodes": 30_000}
        yield _written(folder, f"helix_30000_{kernels}", _rod(helix), kernels)
        for bending in ("hinge", "midedge", "averaged"):
            yield _written(folder, f"{bending}_23000_{kernels}", _sheet(bending, 100), kernels)


def _rod(shape: Mapping[str, object]) -> dict[str, object]:
    return {"type": "rod", "radius": 1e-3, "generate": shape}


def _sheet(bending: str, divisions: int) -> dict[str, object]:
    shape = {"shape": "sheet", "origin": [0, 0, 0], "length": 1, "width": 1, "divisions": divisions}
    return {"type": "shell", "thickness": 1e-3, "bending": bending, "generate": shape}


def _written(
    folder: Path, name: str, body: Mapping[str, object], kernels: str, *, dimension: int = 3
) -> Path:
    held = "body.start" if body["type"] == "rod" else "body.left"
    deck: dict[str, Any] = {
        "schema_version": 1,
        "name": name,
        "dimension": dimension,
        "materials": {"rubber": {"youngs_modulus": 2e6, "poisson_ratio": 0.3, "density": 1200}},
        "geometry": [{**body, "name": "body", "material": "rubber"}],
        "motions": [{"type": "clamp", "where": held}],
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "numerics": {"dt": 1e-3, "t_end": 3e-3, "kernels": kernels},
    }
    file = folder / f"{name}.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return file
