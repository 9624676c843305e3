"""The calls of NumPy that a kernel makes, taken down once and made again without the Python between them.

On few stencils NumPy spends a fraction of a microsecond in a call, and Python as much around it: arrays are
made, views cut, kernels called that call others. All of that is the same every time, since kernels never
branch on data. So a kernel runs once on values that take down what is done to them, and from then on these
calls are made one after another on the arrays of that time, or as few of them as the results asked for need:
an energy alone needs a quarter. They do the same operations, to the last bit.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Sequence
from functools import partial
from operator import call
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from ..arrays import FloatArray

# Up to this width NumPy takes longer for a row with several rows than for repeating it first.
_NARROW: Final = 512


class _Call(NamedTuple):
    """A call that was taken down.

    Attributes:
        reads: Numbers of the values that it reads.
        writes: Number of the value that it writes to.
        run: Makes it again.
    """

    reads: Sequence[int]
    writes: int
    run: Callable[[], Any]


class _Record:
    """What is taken down of one kernel.

    Attributes:
        calls: In order.
        derived: Rows that were repeated or negated, by where they are and how often.
    """

    def __init__(self) -> None:
        self.calls: list[_Call] = []
        self.derived: dict[tuple[int, ...], _Value] = {}
        self._values = 0
        # of values that nobody holds any more, by shape and type
        self._spare: defaultdict[tuple[Any, ...], list[NDArray[Any]]] = defaultdict(list)

    def value(self, like: NDArray[Any]) -> _Value:
        """A new value in an array like this one: in one that is spare, else in it."""
        spare = self._spare[like.shape, like.dtype.char]
        return _Value(_Owner(self, spare.pop() if spare else like))

    def number(self) -> int:
        """Of the next value."""
        self._values += 1
        return self._values

    def give_back(self, array: NDArray[Any]) -> None:
        """Take an array for spare."""
        self._spare[array.shape, array.dtype.char].append(array)


class _Owner:
    """The array of a value, which serves another one when nobody holds the value any more.

    Attributes:
        record: Where it is taken down.
        array: Of the whole value.
        number: Tells it from others that have the array before and after it.
        writes: How often it was written to.
        shared: Whether a kernel may have it twice, and must not change it.
    """

    __slots__ = ("array", "number", "record", "shared", "writes")

    def __init__(self, record: _Record, array: NDArray[Any]) -> None:
        self.record, self.array, self.number = record, array, record.number()
        self.writes, self.shared = 0, False

    def __del__(self) -> None:
        self.record.give_back(self.array)

    def take_down(self, reads: Sequence[int], run: Callable[[], Any]) -> None:
        """A call that writes to it, and the numbers of the values that the call reads."""
        assert not self.shared, "a kernel changes a number that it has twice"
        self.writes += 1
        self.record.calls.append(_Call(reads, self.number, run))


class _Value(NDArrayOperatorsMixin):
    """What a kernel takes for an array: the whole of a value, or a part of it.

    Attributes:
        owner: Of the value.
        array: The part, a view.
    """

    __slots__ = ("array", "owner")

    def __init__(self, owner: _Owner, array: NDArray[Any] | None = None) -> None:
        self.owner = owner
        self.array = owner.array if array is None else array

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the part."""
        return self.array.shape

    @property
    def real(self) -> _Value:
        """Itself: only checks of derivatives take complex numbers."""
        return self

    def __len__(self) -> int:
        return len(self.array)

    def __bool__(self) -> bool:
        raise TypeError("a kernel branches on data")

    def __getitem__(self, key: Any) -> _Value:
        return self._view(self.array[key])

    def __setitem__(self, key: Any, value: Any) -> None:
        part = self[key]
        reads, (given,) = _given((value,))
        self.owner.take_down(reads, partial(np.copyto, part.array, given))

    def reshape(self, *shape: int) -> _Value:
        """The same numbers in another shape."""
        return self._view(self.array.reshape(*shape))

    def copy(self) -> _Value:
        """The same numbers in an array of their own."""
        return self._noted(np.copy, (self,))

    def take(self, rows: Any, axis: int = 0) -> _Value:
        """Copies of rows."""
        assert axis == 0
        made = self.owner.record.value(self.array.take(rows, axis=0))
        # mode="clip" lets NumPy gather without a second array; all rows are there
        made.owner.take_down(
            (self.owner.number,), partial(self.array.take, np.asarray(rows), 0, made.array, "clip")
        )
        return made

    def __pow__(self, exponent: Any) -> _Value:
        # the operator is faster and more exact than the ufunc for squares and roots
        return self._noted(lambda base: base**exponent, (self,))

    def __array_function__(self, function: Any, types: Any, given: Any, named: Any) -> _Value:
        assert not named
        return self._noted(function, given)

    def __array_ufunc__(self, ufunc: Any, method: str, *given: Any, out: Any = None) -> _Value:
        assert method == "__call__"
        shape = np.broadcast(*_given(given)[1]).shape
        if len(shape) == 2 and shape[1] <= _NARROW:
            given = tuple(one.repeated(shape[0]) if _is_row(one) else one for one in given)
        reads, arrays = _given(given)
        (made,) = (self.owner.record.value(ufunc(*arrays)),) if out is None else out
        made.owner.take_down(reads, partial(ufunc, *arrays, made.array))
        return made

    def __neg__(self) -> _Value:
        return self._derived(0, lambda: np.negative(self)) if _is_row(self) else np.negative(self)

    def repeated(self, count: int) -> _Value:
        """A row so many times."""
        return self._derived(count, lambda: self.reshape(1, -1).take(np.zeros(count, dtype=np.int64)))

    def _derived(self, count: int, make: Callable[[], _Value]) -> _Value:
        """What is made of a row, once as long as that is the same."""
        owner, derived = self.owner, self.owner.record.derived
        place = (owner.number, owner.writes, self.array.__array_interface__["data"][0], count)
        if place not in derived:
            derived[place] = make()
            derived[place].owner.shared = True
        return derived[place]

    def _noted(self, function: Callable[..., Any], given: Sequence[Any]) -> _Value:
        """What a function makes that takes no array to write to."""
        reads, arrays = _given(given)
        made = self.owner.record.value(function(*arrays))
        array = made.array
        made.owner.take_down(reads, lambda: np.copyto(array, function(*arrays)))
        return made

    def _view(self, array: NDArray[Any]) -> _Value:
        assert np.may_share_memory(array, self.array), "a kernel indexes stencils"
        return _Value(self.owner, array)


def _is_row(one: Any) -> bool:
    return type(one) is _Value and one.array.ndim == 1


def _given(given: Sequence[Any]) -> tuple[list[int], list[NDArray[Any]]]:
    """Numbers of the values among what a call is given, and all of that as arrays."""
    numbers, arrays = [], []
    for one in given:
        if type(one) is _Value:
            numbers.append(one.owner.number)
            arrays.append(one.array)
        else:
            arrays.append(np.asarray(one))
    return numbers, arrays


def rows_of(result: Any, width: int) -> tuple[NDArray[Any], ...]:
    """A result of a kernel as arrays (k, S), one below the other; for values those that they stand for."""
    parts = result if isinstance(result, tuple) else (result,)
    arrays = (one.array if isinstance(one, _Value) else one for one in parts)
    full = (one if isinstance(one, np.ndarray) else np.full(width, one) for one in arrays)
    return tuple(one.reshape(-1, width) for one in full)


class Replay:
    """A kernel on batches of one width."""

    def __init__(self, function: Callable[..., Any], rows: Sequence[int], width: int) -> None:
        """Take a kernel down.

        Args:
            function: Arrays to results, each a number, an array or a tuple of these.
            rows: Of each argument.
            width: Stencils S.
        """
        record = _Record()
        values = [record.value(np.ones((count, width))) for count in rows]
        self._inputs = [value.array for value in values]
        with np.errstate(all="ignore"):
            results = function(*values)
        self._results = [(_numbers(one), rows_of(one, width)) for one in results]
        self._calls = record.calls
        record.derived.clear()
        self._needed: dict[tuple[int, ...], list[Callable[[], Any]]] = {}

    def run(self, wanted: tuple[int, ...], given: Sequence[FloatArray]) -> list[tuple[NDArray[Any], ...]]:
        """Arrays (k, S) of some results, one below the other, which the next run overwrites."""
        for target, source in zip(self._inputs, given, strict=True):
            target[:] = source
        if wanted not in self._needed:
            self._needed[wanted] = self._only(wanted)
        # a loop without bytecode, in nine tenths of the time
        deque(map(call, self._needed[wanted]), maxlen=0)
        return [self._results[place][1] for place in wanted]

    def _only(self, wanted: tuple[int, ...]) -> list[Callable[[], Any]]:
        """The calls that some results need, in order."""
        needed = {number for place in wanted for number in self._results[place][0]}
        kept = []
        for reads, writes, run in reversed(self._calls):
            if writes in needed:
                needed.update(reads)
                kept.append(run)
        return kept[::-1]


def _numbers(result: Any) -> list[int]:
    """Those of the values of a result."""
    parts = result if isinstance(result, tuple) else (result,)
    return [one.owner.number for one in parts if isinstance(one, _Value)]
