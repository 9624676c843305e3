"""How this package starts itself in another process."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

# The buffers of a picture are many megabytes: the system clears them in a third of the time in large pages.
_LARGE_PAGES = "glibc.malloc.hugetlb=1"


def command(module: str) -> list[str]:
    """Command line that runs a module of this folder."""
    return [sys.executable, "-m", f"dismech_cli.render.{module}"]


def environment(**more: str) -> dict[str, str]:
    """Environment in which the child finds this very package, installed or not, and ``more``."""
    root = str(Path(__file__).resolve().parents[2])
    path = _listed(root, "PYTHONPATH", os.pathsep)
    return {
        **os.environ,
        "PYTHONPATH": path,
        "GLIBC_TUNABLES": _listed(_LARGE_PAGES, "GLIBC_TUNABLES", ":"),
        **more,
    }


def _listed(first: str, variable: str, separator: str) -> str:
    """A list in the environment after one more entry."""
    inherited = os.environ.get(variable)
    return first if not inherited else separator.join([first, inherited])


def describe_exit(code: int) -> str:
    """Say how a process ended."""
    if code >= 0:
        return f"exit code {code}"
    try:
        return f"signal {signal.Signals(-code).name}"
    except ValueError:
        return f"signal {-code}"
