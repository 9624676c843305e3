"""Rows of the elements of a PLY file, never more than it holds."""

from __future__ import annotations

from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from ...arrays import IntArray
from ...errors import MeshError
from ...frozen import frozen


@frozen
class Property:
    """A number of an element, or a list of numbers if ``length`` is the type of its count."""

    name: str
    kind: str
    length: str | None


@frozen
class Element:
    """A kind of rows: how many, and what is in each."""

    name: str
    count: int
    properties: list[Property]


@frozen
class Table:
    """The rows of an element.

    Attributes:
        scalars: Numbers by property, shape (rows,).
        lists: Whole numbers of list properties, all rows one after another.
        ends: Where each row ends among them, shape (rows,).
        lines: Line of each row in a text file, else None.
    """

    scalars: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    lists: dict[str, IntArray] = field(default_factory=dict)
    ends: dict[str, IntArray] = field(default_factory=dict)
    lines: IntArray | None = None


class TextRows:
    """Rows of a text file, one a line.

    Args:
        text: What follows the head.
        line: Lines of the head.
        where: File, for messages.
    """

    def __init__(self, text: str, line: int, where: str) -> None:
        rows = ((line + k, one) for k, one in enumerate(text.splitlines(), start=1))
        self._rows = [(number, one.split()) for number, one in rows if one.strip()]
        self._at = 0
        self._where = where

    def read(self, element: Element) -> Table:
        """The rows of an element."""
        rows = self._rows[self._at : self._at + element.count]
        if len(rows) < element.count:
            raise MeshError(f"{self._where}: {element.count} {element.name!r} announced, {len(rows)} follow")
        self._at += element.count
        scalars: dict[str, list[float]] = {p.name: [] for p in element.properties if p.length is None}
        lists: dict[str, list[int]] = {p.name: [] for p in element.properties if p.length is not None}
        ends: dict[str, list[int]] = {name: [] for name in lists}
        for number, tokens in rows:
            try:
                at = 0
                for one in element.properties:
                    if one.length is None:
                        scalars[one.name].append(float(tokens[at]))
                        at += 1
                        continue
                    size = int(tokens[at])
                    if not 0 <= size < len(tokens) - at:
                        raise IndexError
                    lists[one.name] += [_whole(token) for token in tokens[at + 1 : at + 1 + size]]
                    ends[one.name].append(len(lists[one.name]))
                    at += 1 + size
            except (ValueError, IndexError):
                shown = " ".join(tokens)[:60]
                what = ", ".join(p.name for p in element.properties)
                raise MeshError(
                    f"{self._where}:{number}: {shown!r}; expected the numbers of a {element.name}: {what}"
                ) from None
        return Table(
            {name: np.array(values, dtype=np.float64) for name, values in scalars.items()},
            {name: np.array(values, dtype=np.int64) for name, values in lists.items()},
            {name: np.array(values, dtype=np.int64) for name, values in ends.items()},
            np.array([number for number, _ in rows], dtype=np.int64),
        )


def _whole(token: str) -> int:
    """A node number: some programs write them with a point."""
    value = float(token)
    if not (value == int(value) and abs(value) < 2**53):
        raise ValueError
    return int(value)


class BinaryRows:
    """Rows of a binary file.

    Args:
        data: The file.
        start: Where its rows start.
        order: Byte order, ``<`` or ``>``.
        where: File, for messages.
    """

    def __init__(self, data: bytes, start: int, order: str, where: str) -> None:
        self._data = data
        self._at = start
        self._order = order
        self._where = where

    def read(self, element: Element) -> Table:
        """The rows of an element: all at once where they are alike, else one by one."""
        sizes = [self._first_size(element, k) for k in range(len(element.properties))]
        fields = [self._field(one, size) for one, size in zip(element.properties, sizes, strict=True)]
        row = np.dtype([(f"p{k}", *one) for k, one in enumerate(fields)])
        table = self._alike(element, row, sizes)
        return self._one_by_one(element) if table is None else table

    def _first_size(self, element: Element, last: int) -> int:
        """Length of a list property in the next row, if those before it are as long as they say."""
        at = self._at
        for k, one in enumerate(element.properties[: last + 1]):
            if one.length is None:
                at += np.dtype(one.kind).itemsize
                continue
            size = self._count(one, at)
            if k == last:
                return size
            at += np.dtype(one.length).itemsize + max(size, 0) * np.dtype(one.kind).itemsize
        return 0

    def _count(self, one: Property, at: int) -> int:
        """Length of a list that starts at a place, 0 past the end of the file."""
        kind = np.dtype(self._order + str(one.length))
        if kind.kind == "f":
            raise MeshError(f"{self._where}: property {one.name!r} counts its numbers by {one.length}")
        if at + kind.itemsize > len(self._data):
            return 0
        return int(np.frombuffer(self._data, kind, 1, at)[0])

    def _field(self, one: Property, size: int) -> tuple[object, ...]:
        kind = self._order + one.kind
        if one.length is None:
            return (kind,)
        # A damaged length must not make a type that is larger than the file.
        size = min(max(size, 0), len(self._data))
        return (np.dtype([("n", self._order + one.length), ("v", kind, (size,))]),)

    def _alike(self, element: Element, row: np.dtype[np.void], sizes: list[int]) -> Table | None:
        """The rows if all lists are as long as those of the first row."""
        if row.itemsize == 0 or element.count * row.itemsize > len(self._data) - self._at:
            return None
        found = np.frombuffer(self._data, row, element.count, self._at)
        table = Table()
        for k, (one, size) in enumerate(zip(element.properties, sizes, strict=True)):
            values = found[f"p{k}"]
            if one.length is None:
                with np.errstate(invalid="ignore"):
                    table.scalars[one.name] = values.astype(np.float64)
                continue
            if (values["n"] != size).any():
                return None
            table.lists[one.name] = _integers(values["v"]).reshape(-1)
            table.ends[one.name] = size * np.arange(1, element.count + 1)
        self._at += element.count * row.itemsize
        return table

    def _one_by_one(self, element: Element) -> Table:
        least = sum(np.dtype(one.length or one.kind).itemsize for one in element.properties)
        left = len(self._data) - self._at
        if element.count * least > left:
            raise MeshError(
                f"{self._where}: {element.count} {element.name!r} announced, of {least} bytes at least; "
                f"{left} bytes follow"
            )
        scalars: dict[str, list[float]] = {p.name: [] for p in element.properties if p.length is None}
        lists: dict[str, list[NDArray[np.int64]]] = {p.name: [] for p in element.properties if p.length}
        for _ in range(element.count):
            for one in element.properties:
                if one.length is None:
                    scalars[one.name].append(float(self._take(one.kind, 1)[0]))
                    continue
                size = int(self._take(one.length, 1)[0])
                lists[one.name].append(_integers(self._take(one.kind, size)))
        none = np.empty(0, dtype=np.int64)
        return Table(
            {name: np.array(values, dtype=np.float64) for name, values in scalars.items()},
            {name: np.concatenate((none, *rows)) for name, rows in lists.items()},
            {name: np.cumsum([len(row) for row in rows], dtype=np.int64) for name, rows in lists.items()},
        )

    def _take(self, kind: str, count: int) -> NDArray[np.generic]:
        found = np.dtype(self._order + kind)
        left = (len(self._data) - self._at) // found.itemsize
        if not 0 <= count <= left:
            raise MeshError(f"{self._where}: a list of {count} numbers announced, {left} follow")
        self._at += count * found.itemsize
        return np.frombuffer(self._data, found, count, self._at - count * found.itemsize)


def _integers(values: NDArray[np.generic]) -> IntArray:
    """Whole numbers; what is none becomes -1, which names no node."""
    if values.dtype.kind != "f":
        return values.astype(np.int64)
    with np.errstate(invalid="ignore"):
        whole = np.where(values == np.floor(values), values, -1.0)
        return np.where(np.abs(whole) < 2**53, whole, -1.0).astype(np.int64)
