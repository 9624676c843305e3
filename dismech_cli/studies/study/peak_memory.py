"""The most memory that this process has had, since a moment where the system can tell."""

from __future__ import annotations

from contextlib import suppress
from math import nan
from pathlib import Path
from typing import Final

_PROCESS: Final = Path("/proc/self")


def watch_peak() -> None:
    """Forget earlier peaks; where the system cannot, later ones are those since the start."""
    with suppress(OSError):
        (_PROCESS / "clear_refs").write_text("5", encoding="ascii")


def peak_memory() -> float:
    """Largest resident size [byte]; NaN where the system does not tell."""
    with suppress(OSError, ValueError):
        for line in (_PROCESS / "status").read_text(encoding="ascii").splitlines():
            name, _, value = line.partition(":")
            if name == "VmHWM":
                return 1024.0 * float(value.split()[0])
    return nan
