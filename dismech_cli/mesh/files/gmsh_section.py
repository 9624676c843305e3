"""The numbers of one section of a gmsh file, text or binary, never more than it holds."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import islice
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import MeshError


class Section:
    """The numbers of a section in file order; more than it holds are never allocated.

    ``size`` is the type of counts and tags in binary files and empty for text.
    """

    def __init__(self, body: bytes, line: int, where: str, size: str) -> None:
        self.body = body
        self.size = size
        self.position = 0
        self._where = where
        self._line = line
        self._tokens = [] if size else body.split()

    def take(self, count: int, kind: Literal["int", "size", "float"]) -> NDArray[Any]:
        """Take the next numbers, shape (count,)."""
        dtype = np.dtype({"int": "i4", "size": self.size, "float": "f8"}[kind] if self.size else "u1")
        left = (len(self.body if self.size else self._tokens) - self.position) // dtype.itemsize
        if not 0 <= count <= left:
            raise self.error(f"{count} numbers announced, {left} follow in the section")
        start = self.position
        self.position += count * dtype.itemsize
        if self.size:
            numbers = np.frombuffer(self.body, dtype, count, start)
        else:
            numbers = self._parse(start, float if kind == "float" else _whole)
        if kind == "size" and count and not 0 <= numbers.min() <= numbers.max() < 1 << 63:
            raise self.error("a count or number is negative or too large", start)
        return numbers.astype(np.float64 if kind == "float" else np.int64)

    def _parse(self, start: int, convert: Callable[[bytes], float]) -> NDArray[Any]:
        numbers: list[float] = []
        try:
            for token in self._tokens[start : self.position]:
                numbers.append(convert(token))
        except ValueError:
            shown = token[:40].decode("ascii", errors="replace")
            expected = "a whole number" if convert is _whole else "a number"
            raise self.error(f"{shown!r}; expected {expected}", start + len(numbers)) from None
        return np.array(numbers)

    def rows_alike(self, start: int, stride: int, most: int) -> int:
        """Count the text rows from ``start`` that repeat the second and third number of the first."""
        rows, head = 1, self._tokens[start + 1 : start + 3]
        while rows < most and self._tokens[(at := start + rows * stride) + 1 : at + 3] == head:
            rows += 1
        return rows

    def lines(self, start: int, stride: int) -> list[bytes]:
        """Return the tokens taken since ``start`` as lines of ``stride`` tokens."""
        return [b" ".join(self._tokens[at : at + stride]) for at in range(start, self.position, stride)]

    def error(self, message: str, at: int | None = None) -> MeshError:
        """Return an error that names the line of a token, by default the next; bytes have no line."""
        if self.size:
            return MeshError(f"{self._where}: {message}")
        at = self.position if at is None else at
        token = next(islice(re.finditer(rb"\S+", self.body), at, None), None)
        end = len(self.body) if token is None else token.start()
        line = self._line + self.body.count(b"\n", 0, end)
        return MeshError(f"{self._where}:{line}: {message}")


def _whole(token: bytes) -> int:
    if len(token) > 18:
        raise ValueError
    return int(token)
