"""Code that Numba kept, read back without making ready to compile."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from functools import partial
from importlib import import_module
from types import ModuleType
from typing import Any


def read_alone(module: ModuleType) -> None:
    """Let loops that were kept be read without the tables of all that Numba can compile.

    It fills them before it looks into its cache, a fifth of a second; what it finds there needs none, and
    where it finds nothing it fills them once more before it compiles. Where its insides are others than
    those known here, its own way stays.
    """
    with suppress(ImportError, AttributeError):
        # insides of Numba, which its types do not tell of
        inside: Any = import_module("numba.core")
        for part in ("caching", "dispatcher", "runtime"):
            import_module(f"numba.core.{part}")
        for loop in vars(module).values():
            kept = loop._cache if isinstance(loop, inside.dispatcher.Dispatcher) else None
            if isinstance(kept, inside.caching.FunctionCache):
                guard, read = kept._guard_against_spurious_io_errors, kept._load_overload
                kept.load_overload = partial(_read, inside.runtime.rtsys.initialize, guard, read)


def _read(
    start: Callable[[Any], None],
    guard: Callable[[], AbstractContextManager[None]],
    read: Callable[[Any, Any], Any],
    signature: Any,
    target: Any,
) -> Any:
    """What was kept for some types of arguments, or None.

    Args:
        start: Starts what compiled code calls.
        guard: Takes for nothing what another process holds at this moment.
        read: Reads what was kept.
        signature: The types.
        target: What code is made for.
    """
    start(target)
    found = None
    with guard():
        found = read(signature, target)
    return found
