"""Pipes that pictures go through from one process to another."""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import IO

_MOST = 1 << 20  # bytes that anybody may ask for


def widen(pipe: IO[bytes]) -> None:
    """Let a pipe hold much of a picture, where the system allows it: its two ends take turns less often."""
    if sys.platform == "linux":
        from fcntl import F_SETPIPE_SZ, fcntl

        with suppress(OSError):
            fcntl(pipe, F_SETPIPE_SZ, _MOST)
