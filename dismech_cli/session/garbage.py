"""Python's search for cycles of garbage, put off while a program starts."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def search_postponed() -> Iterator[None]:
    """Search from :func:`search` on, or after the block.

    Modules and schemas stay; looking at them again and again takes a tenth of the time of a short run.
    """
    searched = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if searched:
            gc.enable()


def search() -> None:
    """If it was put off: search from now on, but not among what is there, which stays."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()
