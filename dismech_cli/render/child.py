"""How this package starts itself in another process."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path


def command(module: str) -> list[str]:
    """Command line that runs a module of this folder."""
    return [sys.executable, "-m", f"dismech_cli.render.{module}"]


def environment(**more: str) -> dict[str, str]:
    """Environment in which the child finds this very package, installed or not, and ``more``."""
    root = str(Path(__file__).resolve().parents[2])
    inherited = os.environ.get("PYTHONPATH")
    path = root if not inherited else os.pathsep.join([root, inherited])
    return {**os.environ, "PYTHONPATH": path, **more}


def describe_exit(code: int) -> str:
    """Say how a process ended."""
    if code >= 0:
        return f"exit code {code}"
    try:
        return f"signal {signal.Signals(-code).name}"
    except ValueError:
        return f"signal {-code}"
