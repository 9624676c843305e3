"""MKL PARDISO driven phase by phase.

pypardiso finds and loads MKL; its own solve path repeats the symbolic phase, hashes the matrix and
treats every matrix as unsymmetric, so the phases are called here directly.
"""

from __future__ import annotations

import ctypes
import os
import sys
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, cached_property
from pathlib import Path
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray
from ..pattern import SparsityPattern
from .factors import FactorizationError, checked, price_of

# Below this order minimum degree gives factors no larger than nested dissection, and finds them sooner
# (benchmarks/shells.py: 2.2 ms instead of 2.5 ms at 1500 DOFs, 80 ms instead of 67 ms at 15 000).
_SMALL = 5000
_PLACE: Final = "PYPARDISO_MKL_RT"
_PLAIN, _TRANSPOSED = 0, 2  # values of iparm(12)
_MINIMUM_DEGREE, _NESTED_DISSECTION = 0, 2
_ANALYSE, _FACTORISE, _SOLVE, _RELEASE = 11, 22, 33, -1
POSITIVE_DEFINITE, _INDEFINITE, _UNSYMMETRIC = 2, -2, 11


@cache
def _entry_point() -> Any:
    """PARDISO in the loaded MKL library; raises ImportError where there is none."""
    with _told(_where()):
        from pypardiso import PyPardisoSolver

        library = PyPardisoSolver().libmkl
    # By index, not by name: a function object of its own, without pypardiso's argument types.
    function = library["pardiso"]
    function.restype = None
    return function


def _where() -> Path | None:
    """MKL's library where pip and conda put it; None where it is elsewhere."""
    folders = (Path(sys.prefix) / "lib", Path(sys.prefix) / "Library" / "bin")
    names = ("libmkl_rt.so*", "libmkl_rt*.dylib", "mkl_rt*.dll")
    return next((file for folder in folders for name in names for file in sorted(folder.glob(name))), None)


@contextmanager
def _told(library: Path | None) -> Iterator[None]:
    """Tell pypardiso where it is, unless the user does: it would ask the linker and the compiler, twice."""
    if library is None or _PLACE in os.environ:
        yield
        return
    os.environ[_PLACE] = str(library)
    try:
        yield
    finally:
        del os.environ[_PLACE]


def pardiso_available() -> bool:
    """Whether pypardiso is installed and loads its MKL library; a broken one raises anything."""
    try:
        _entry_point()
    except Exception:
        return False
    return True


class PardisoSolver:
    """Symbolic analysis once per pattern, symmetric factorisation where the matrix is symmetric.

    A symmetric matrix is taken as positive definite; where that fails, as indefinite. Each type is
    analysed when it first occurs.
    """

    name: ClassVar[str] = "pardiso"

    def __init__(self, pattern: SparsityPattern) -> None:
        self._pattern = pattern
        self._kinds = (POSITIVE_DEFINITE, _INDEFINITE) if pattern.symmetric else (_UNSYMMETRIC,)
        self._handles: dict[int, PardisoFactors] = {}
        self._rough: RoughFactors | None = None

    def factorize(self, values: FloatArray) -> PardisoFactors:
        """Factorise; raise :class:`FactorizationError` if every matrix type fails."""
        stored = values[: self._pattern.nnz]
        if not np.isfinite(stored).all():
            raise FactorizationError("the matrix is not finite")
        for kind in self._kinds:
            if kind not in self._handles:
                self._handles[kind] = PardisoFactors(kind, self._pattern)
            if self._handles[kind].factorize(stored):
                return self._handles[kind]
        raise FactorizationError("PARDISO met a zero pivot: some part is free to move")

    def nearly(self, values: FloatArray, cheap: float) -> RoughFactors | None:
        """Factors in single precision; none of what is small, not symmetric or not positive definite."""
        if self._pattern.m < _SMALL or not self._pattern.symmetric:
            return None
        if self._rough is None:
            self._rough = RoughFactors(self._pattern)
        rough = self._rough
        return rough if rough.price >= cheap and rough.factorize(values[: self._pattern.nnz]) else None


class InertiaCounter:
    """Counts negative eigenvalues of symmetric matrices on one pattern (Sylvester's law)."""

    def __init__(self, pattern: SparsityPattern) -> None:
        self._nnz = pattern.nnz
        self._handle = PardisoFactors(_INDEFINITE, pattern)

    def count(self, values: FloatArray) -> int:
        """Number of negative eigenvalues; raise :class:`FactorizationError` if singular."""
        if not self._handle.factorize(values[: self._nnz]):
            raise FactorizationError("PARDISO met a zero pivot")
        return self._handle.negative_eigenvalues


class PardisoFactors:
    """One PARDISO instance: one pattern, one matrix type, analysed at the first matrix."""

    def __init__(self, kind: int, pattern: SparsityPattern) -> None:
        self._kind = kind
        self._values = np.zeros(pattern.nnz)
        self._instance = _Instance.of(kind, self._values, pattern)
        self._iparm = self._instance.iparm
        # views of the same values; made once, because a transpose costs more than a small product
        self._matrix = pattern.csr(self._values)
        self._transposed = self._matrix.T
        self._diagonal = pattern.diagonal
        self._finalizer = weakref.finalize(self, self._instance.release)

    def factorize(self, values: FloatArray) -> bool:
        """Numerical factorisation; False if the matrix does not fit the type."""
        self._values[:] = values
        return self._instance.factorize()

    @property
    def indefinite(self) -> bool:
        """Cholesky's method failed."""
        return self._kind == _INDEFINITE

    @property
    def price(self) -> float:
        """By the analysis."""
        return self._instance.price

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors."""
        return checked(rhs, lambda b: self._solve(b, _PLAIN), self._product)

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors, transposed."""
        if self._kind != _UNSYMMETRIC:
            return self.solve(rhs)
        return checked(rhs, lambda b: self._solve(b, _TRANSPOSED), lambda x: self._transposed @ x)

    def _solve(self, rhs: FloatArray, side: int) -> FloatArray:
        b = np.asfortranarray(rhs)
        x = np.empty_like(b)
        self._iparm[11] = side
        if self._instance.call(_SOLVE, b, x) != 0:
            raise FactorizationError("PARDISO could not solve with its factors")
        return x

    def _product(self, x: FloatArray) -> FloatArray:
        y: FloatArray = self._matrix @ x
        if self._kind != _UNSYMMETRIC:
            y += self._transposed @ x
            y -= self._values[self._diagonal] * x
        return y

    @property
    def negative_eigenvalues(self) -> int:
        """Of the last matrix, where it was taken as indefinite."""
        return int(self._iparm[22])


class RoughFactors:
    """Those of a positive definite matrix in single precision: good to six digits, for less time and memory.

    Solutions are not checked, as they are steps of an iteration.
    """

    indefinite: ClassVar[bool] = False

    def __init__(self, pattern: SparsityPattern) -> None:
        self._values = np.zeros(pattern.nnz, dtype=np.float32)
        self._instance = _Instance.of(POSITIVE_DEFINITE, self._values, pattern)
        self._finalizer = weakref.finalize(self, self._instance.release)

    def factorize(self, values: FloatArray) -> bool:
        """Numerical factorisation; False if the matrix is not positive definite, as far as it can be seen."""
        self._values[:] = values
        return self._instance.factorize()

    @property
    def price(self) -> float:
        """By the analysis."""
        return self._instance.price

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve with the last factors, shape (m,)."""
        # small forces are smaller than the least number in single precision
        size = float(np.abs(rhs).max())
        b = (rhs / size).astype(np.float32)
        x = np.empty_like(b)
        if self._instance.call(_SOLVE, b, x) != 0:
            raise FactorizationError("PARDISO could not solve with its factors")
        return size * x.astype(np.float64)

    def solve_transposed(self, rhs: FloatArray) -> FloatArray:
        """The same: the matrix is symmetric."""
        return self.solve(rhs)


class _Instance:
    """An instance of PARDISO: its memory, and what every call of it is given, at places that stay."""

    @classmethod
    def of(cls, kind: int, values: NDArray[np.floating[Any]], pattern: SparsityPattern) -> _Instance:
        """For matrices of a pattern whose values stand in an array; its precision is that of the factors."""
        made = cls(kind, values, pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32))
        iparm = made.iparm
        iparm[0] = 1  # own parameters
        iparm[1] = _MINIMUM_DEGREE if pattern.m < _SMALL else _NESTED_DISSECTION
        iparm[9] = 8 if kind == _INDEFINITE else 13  # pivot perturbation 1e-8 / 1e-13
        # No matching or scaling (11, 13): they read the values during analysis, and a resumed run
        # that analyses at other values would not repeat a straight run bit by bit.
        iparm[17] = iparm[18] = -1  # count entries of the factors, and operations
        iparm[20] = 1  # Bunch-Kaufman pivots
        iparm[27] = int(values.dtype == np.float32)  # single precision
        iparm[34] = 1  # zero-based indices
        return made

    def __init__(
        self,
        kind: int,
        values: NDArray[np.floating[Any]],
        rows: NDArray[np.int32],
        columns: NDArray[np.int32],
    ) -> None:
        self.memory = np.zeros(64, dtype=np.int64)
        self.iparm = np.zeros(64, dtype=np.int32)
        self._function = _entry_point()
        self._arrays = values, rows, columns, np.zeros(1, dtype=np.int32)  # alive as long as their addresses
        self._phase, self._sides, self._error = ctypes.c_int32(), ctypes.c_int32(), ctypes.c_int32()
        one, order = _integer(1), _integer(len(rows) - 1)
        self._arguments = (
            *(_address(self.memory), one, one, _integer(kind), ctypes.byref(self._phase), order),
            *(*map(_address, self._arrays), ctypes.byref(self._sides)),
            *(_address(self.iparm), _integer(0)),
        )

    def factorize(self) -> bool:
        """Numerical factorisation; False if the matrix does not fit the type."""
        return self._analysed and self.call(_FACTORISE) == 0

    @property
    def price(self) -> float:
        """How many solutions take as long as a factorisation, by the analysis."""
        return price_of(1e6 * float(self.iparm[18]), float(self.iparm[17])) if self._analysed else 0.0

    @cached_property
    def _analysed(self) -> bool:
        """Whether the analysis, which happens here, went well."""
        return self.call(_ANALYSE) == 0

    def call(
        self,
        phase: int,
        b: NDArray[np.floating[Any]] | None = None,
        x: NDArray[np.floating[Any]] | None = None,
    ) -> int:
        """Go through a phase; PARDISO's error code.

        Args:
            phase: Its number.
            b: Right-hand sides, shape (m,) or (m, k) column by column.
            x: Written, the solutions.
        """
        self._phase.value = phase
        self._sides.value = b.shape[1] if b is not None and b.ndim == 2 else 1
        self._error.value = 0
        self._function(*self._arguments, _address(b), _address(x), ctypes.byref(self._error))
        return self._error.value

    def release(self) -> None:
        """Give MKL's memory back."""
        if self.memory.any():
            self.call(_RELEASE)


def _address(array: Any) -> Any:
    return None if array is None else ctypes.c_void_p(array.ctypes.data)


def _integer(value: int) -> Any:
    return ctypes.byref(ctypes.c_int32(value))
