"""Runs the same kernel text in compiled loops (extra ``[fast]``).

The loops are modules in the user's cache folder, in a subfolder named by a hash of all kernel
sources: Numba's own cache does not notice an edit of a function that a loop calls.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..geometry.kernel import marked_kernels
from .driver import DragLoop, StencilLoop
from .linearization import Linearization, Pattern
from .numba_source import drag_source, map_source, stencil_source
from .shape import DragKernel, Kernel

# Reassociation and contraction only: never nnan or ninf, which delete checks for NaN. Kernels are
# inlined into their loops, so that a loop that wants the residual alone computes nothing else.
_KERNEL_OPTIONS: Any = {"fastmath": {"nsz", "arcp", "contract", "afn", "reassoc"}, "forceinline": True}


@cache
def _digest_of_sources() -> str:
    package = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    for layer in ("geometry", "kinematics", "kernels", "energies", "forces"):
        for source in sorted((package / layer).glob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Folder of loops and compiled code: user cache directory / hash of the kernel sources.

    ``DISMECH_CACHE`` names another place; without a writable one a temporary folder serves.
    """
    chosen = os.environ.get("DISMECH_CACHE") or os.environ.get("XDG_CACHE_HOME")
    base = Path(chosen) if chosen else Path.home() / ".cache"
    name = _digest_of_sources()
    folder = base / "dismech" / "kernels" / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"dismech-kernels-{os.getuid()}-{name}"
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def is_compiled(folder: Path) -> bool:
    """Whether some kernels of these sources have been compiled before."""
    return any(folder.rglob("*.nbi"))


_REGISTERED: set[Callable[..., Any]] = set()


def _returning(text: Callable[..., Any]) -> Callable[..., Any]:
    """What ``numba.extending.overload`` wants: a function that returns the text to compile."""

    def choose(*args: Any, **kwargs: Any) -> Callable[..., Any]:
        return text

    return choose


def _load(name: str, text: str) -> ModuleType:
    """Import a module of loops, writing it first where its text is not on disk yet."""
    import numba

    numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]
    for function, compiled in marked_kernels():
        if function not in _REGISTERED:
            numba.extending.overload(function, jit_options=_KERNEL_OPTIONS, strict=False)(
                _returning(compiled)
            )
            _REGISTERED.add(function)
    path = cache_folder() / f"{name}.py"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        # written aside and renamed: two runs may start at the same time
        partial = path.with_suffix(f".{os.getpid()}.tmp")
        partial.write_text(text, encoding="utf-8")
        partial.replace(path)
    spec = importlib.util.spec_from_file_location(f"dismech_loops_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # code loaded from Numba's cache looks its module up by name
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def _unsigned(indices: IntArray) -> NDArray[np.uint32]:
    """Row-major unsigned indices: no check for negative ones, half the memory of the usual integers."""
    return np.ascontiguousarray(indices, dtype=np.uint32)


@cache
def _stencil_loops(kernel: Kernel) -> ModuleType:
    return _load(f"{kernel.function.__name__}_stencils", stencil_source(kernel))


class NumbaStencilLoop:
    """Serial compiled loop over stencils."""

    def __init__(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> None:
        self._loops = _stencil_loops(kernel)
        self._energies = kernel.energies
        self._indices = (_unsigned(dofs), _unsigned(auxiliaries))
        i, j = kernel.local_pairs
        self._slots = _unsigned(pattern.symmetric_slots(dofs[:, i], dofs[:, j]))

    def energy(self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray) -> FloatArray:
        """Shares of the energy of each stencil [J]."""
        out = np.empty((self._energies, parameters.shape[1]))
        self._loops.energies(q, auxiliary, parameters, *self._indices, out)
        return out

    def add_residual(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, r: FloatArray
    ) -> None:
        """Add dE/dq."""
        self._loops.residual(q, auxiliary, parameters, *self._indices, r)

    def add_linearization(
        self, q: FloatArray, auxiliary: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add dE/dq and d2E/dq2."""
        self._loops.linearization(
            q, auxiliary, parameters, *self._indices, into.residual, into.stiffness, self._slots
        )


@cache
def _drag_loops(kernel: DragKernel) -> ModuleType:
    return _load(f"{kernel.function.__name__}_drag", drag_source(kernel))


class NumbaDragLoop:
    """Serial compiled loop over drag stencils."""

    def __init__(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> None:
        self._loops = _drag_loops(kernel)
        self._dofs = _unsigned(dofs)
        loaded = dofs[:, kernel.loaded_dofs]
        row, column, _, _ = kernel.stiffness_table
        i, j = np.divmod(np.arange(kernel.forces**2), kernel.forces)
        self._slots = (
            _unsigned(pattern.slots_of(dofs[:, row], dofs[:, column])),
            _unsigned(pattern.slots_of(loaded[:, i], loaded[:, j])),
        )

    def add_residual(self, q: FloatArray, v: FloatArray, parameters: FloatArray, r: FloatArray) -> None:
        """Add -f."""
        self._loops.residual(q, v, parameters, self._dofs, r)

    def add_linearization(
        self, q: FloatArray, v: FloatArray, parameters: FloatArray, into: Linearization
    ) -> None:
        """Add -f, -df/dq and -df/dv."""
        self._loops.linearization(
            q, v, parameters, self._dofs, into.residual, into.stiffness, into.damping, *self._slots
        )


@cache
def _map_loop(function: Callable[..., Any], inputs: int, outputs: int) -> ModuleType:
    return _load(f"{function.__name__}_map", map_source(function, inputs, outputs))


@dataclass(frozen=True, slots=True)
class NumbaDriver:
    """Compiled loops; needs the extra ``[fast]``."""

    name: str = "numba"

    def stencil(self, kernel: Kernel, dofs: IntArray, auxiliaries: IntArray, pattern: Pattern) -> StencilLoop:
        """Loop of an energy kernel."""
        return NumbaStencilLoop(kernel, dofs, auxiliaries, pattern)

    def drag(self, kernel: DragKernel, dofs: IntArray, pattern: Pattern) -> DragLoop:
        """Loop of a drag kernel."""
        return NumbaDragLoop(kernel, dofs, pattern)

    def map(self, function: Callable[[Any], Any], inputs: FloatArray, outputs: int) -> FloatArray:
        """Apply a kernel column by column."""
        out = np.empty((outputs, inputs.shape[1]))
        _map_loop(function, len(inputs), outputs).loop(inputs, out)
        return out
