"""Pictures that the scenario asks for, made in a process of their own after the run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from ..scenario.output import Render
from .console import Console


def wanted(render: Render) -> bool:
    """Whether the scenario asks for any picture."""
    return render.video != "none" or render.still or bool(render.plots)


def make_pictures(run_dir: Path, console: Console) -> list[str]:
    """Draw what the scenario of a run asks for; a failure is a warning, as the run itself is done.

    Returns:
        The files made.
    """
    console.say("rendering ...")
    root = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])
    child = subprocess.run(
        [sys.executable, "-m", "dismech_cli", "render", str(run_dir), "--json", "--quiet"],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    if child.returncode != 0:
        reason = child.stderr.strip().removeprefix("error: ") or f"the renderer ended with {child.returncode}"
        console.warn(f"no pictures: {reason}\n  later: dismech render {run_dir}")
        return []
    files: list[str] = json.loads(child.stdout)["files"]
    return files
