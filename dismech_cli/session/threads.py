"""Thread settings, which the libraries read once, when they are loaded."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path

from ..output.threads import COUNTS, REPRODUCIBLE

_MANIFEST = "manifest.json"


def use_threads(threads: int | None, deterministic: bool) -> None:
    """Set the number of threads; call it before NumPy is imported.

    Args:
        threads: For all libraries. None leaves what the environment says, else takes one: two do not
            help below some 10 000 degrees of freedom.
        deterministic: Makes MKL give the same bits on every run.
    """
    for name in COUNTS:
        if threads is not None:
            os.environ[name] = str(threads)
        else:
            os.environ.setdefault(name, "1")
    if deterministic:
        os.environ[REPRODUCIBLE] = "AUTO"


def use_threads_of(run_dir: Path) -> None:
    """Set what a run was started with, so that its continuation gives the same bits."""
    # what is damaged is told by whoever reads the whole manifest
    with contextlib.suppress(OSError, ValueError, TypeError, LookupError):
        recorded = json.loads((run_dir / _MANIFEST).read_text(encoding="utf-8"))["threads"]
        for name in (*COUNTS, REPRODUCIBLE):
            if name in recorded:
                os.environ[name] = str(recorded[name])
    use_threads(None, False)
