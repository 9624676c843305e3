"""The environment variables that set the number of threads; importing this imports no library."""

from __future__ import annotations

import os

COUNTS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
REPRODUCIBLE = "MKL_CBWR"


def thread_settings() -> dict[str, str]:
    """Those that are set, with their values."""
    return {name: os.environ[name] for name in (*COUNTS, REPRODUCIBLE) if name in os.environ}
