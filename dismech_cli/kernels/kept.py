"""Which loops have been compiled before and kept."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress

from .cache import cache_folder
from .loop_text import LoopText


def missing(texts: Collection[LoopText]) -> int:
    """How many of some modules of loops are still to compile: the cache of this user lacks them."""
    found: set[str] = set()
    with suppress(OSError):
        found = {path.name.partition("-")[0] for path in cache_folder().rglob("*.nbi")}
    return sum(f"{text.name}.{text.main}" not in found for text in texts)
