"""Modules of compiled loops: written, imported, and made anew where the cache turns out broken."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from ..geometry.kernel import marked_kernels
from .cache import cache_folder, temporary_folder
from .kept_code import read_alone
from .loop_text import FASTMATH, LoopText
from .numba_source import not_kept

# Kernels are inlined into their loops, so that a loop that wants the residual alone computes nothing else.
# Nothing but these calls them: no wrapper for others is compiled.
_KERNEL_OPTIONS: Any = {"fastmath": set(FASTMATH), "forceinline": True, "no_cfunc_wrapper": True}

_REGISTERED: set[Callable[..., Any]] = set()


class LoopModule:
    """The loops of one kernel in one shape.

    Numba looks into its cache when a loop is first called with some types of arguments, so a file that
    a full disk cut short, or that cannot be read, shows only there, before the loop has done anything.
    Such files are removed and the loops compiled again; if that fails too, in a temporary folder, and in
    memory alone where there is no room for one.
    """

    def __init__(self, loops: LoopText) -> None:
        self._name, self._text = loops.name, loops.text
        self._repairs = [self._compiled_again, self._elsewhere, self._in_memory]
        try:
            self._module = _imported(self._name, self._text, cache_folder())
        except (OSError, RuntimeError) as error:  # Numba has a RuntimeError for what it cannot write to
            self._warn(error)
            self._module = self._elsewhere()

    def run(self, loop: str, *arguments: Any) -> Any:
        """Call a loop by its name."""
        while True:
            try:
                return getattr(self._module, loop)(*arguments)
            except Exception as error:
                if not self._repairs or _is_mistake(error):
                    raise
                self._warn(error)
                self._module = self._repairs.pop(0)()

    def _warn(self, error: Exception) -> None:
        reason = f"{type(error).__name__}: {error}"
        warnings.warn(f"the cache of compiled kernels failed for {self._name} ({reason})", stacklevel=3)

    def _compiled_again(self) -> ModuleType:
        try:
            for path in cache_folder().rglob(f"{self._name}.*.nb[ic]"):
                path.unlink(missing_ok=True)
        except OSError:
            return self._elsewhere()
        return _imported(self._name, self._text, cache_folder())

    def _elsewhere(self) -> ModuleType:
        try:
            return _imported(self._name, self._text, temporary_folder())
        except (OSError, RuntimeError):
            return self._in_memory()

    def _in_memory(self) -> ModuleType:
        return _executed(self._name, not_kept(self._text), Path(f"{self._name}.py"))


def _is_mistake(error: Exception) -> bool:
    """Whether it is the text of the kernel that Numba refuses."""
    from numba.core.errors import NumbaError

    return isinstance(error, NumbaError)


def _imported(name: str, text: str, folder: Path) -> ModuleType:
    """Run the text of a module of loops, written first where it is not on disk yet."""
    import numba

    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    path, source = folder / f"{name}.py", text.encode()
    if not path.exists() or path.read_bytes() != source:
        # written aside and renamed: two runs may start at the same time
        partial = path.with_suffix(f".{os.getpid()}.tmp")
        try:
            partial.write_bytes(source)
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)
    return _executed(name, text, path)


def _executed(name: str, text: str, path: Path) -> ModuleType:
    """Run the text of a module of loops."""
    import numba

    for function, compiled in marked_kernels():
        if function not in _REGISTERED:
            overload = numba.extending.overload(function, jit_options=_KERNEL_OPTIONS, strict=False)
            overload(_returning(compiled))
            _REGISTERED.add(function)
    module = ModuleType(f"dismech_loops_{name}")
    module.__file__ = str(path)
    # code loaded from Numba's cache looks its module up by name
    sys.modules[module.__name__] = module
    exec(compile(text, path, "exec"), vars(module))
    read_alone(module)
    return module


def _returning(text: Callable[..., Any]) -> Callable[..., Any]:
    """What ``numba.extending.overload`` wants: a function that returns the text to compile."""

    def choose(*args: Any, **kwargs: Any) -> Callable[..., Any]:
        return text

    return choose
