"""Lines and numbers of VTK's older files, never more than they hold."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import MeshError
from ..limits import MAX_COUNT

_TYPES = {
    "bit": "u1", "char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2", "int": "i4",
    "unsigned_int": "u4", "long": "i8", "unsigned_long": "u8", "float": "f4", "double": "f8",
    "vtktypeint64": "i8", "vtkidtype": "i8", "vtktypeint32": "i4",
}  # fmt: skip
# Numbers per node of all cells: more cannot be meshes that are taken.
_MOST = 16 * MAX_COUNT


class VtkStream:
    """Goes through a file from a place on.

    Args:
        data: The file.
        at: Where to start.
        binary: Whether numbers are bytes rather than text.
        where: File, for messages.
    """

    def __init__(self, data: bytes, at: int, binary: bool, where: str) -> None:
        self._data = data
        self._at = at
        self._binary = binary
        self.where = where

    def next_starts(self, keyword: str) -> bool:
        """Whether the next line starts with a keyword; it is not gone past."""
        mark = self._at
        words = self.line()
        self._at = mark
        return starts(words, keyword)

    def skip_metadata(self) -> None:
        """Go past the blank line that ends it."""
        end = self._data.find(b"\n\n", self._at)
        self._at = len(self._data) if end < 0 else end + 2

    def line(self) -> list[str]:
        """The words of the next line that holds some; none at the end."""
        while self._at < len(self._data):
            end = self._data.find(b"\n", self._at)
            end = len(self._data) if end < 0 else end
            words = self._data[self._at : min(end, self._at + 400)].decode("utf-8", "replace").split()
            self._at = end + 1
            if words:
                return words
        return []

    def whole(self, token: str) -> int:
        """A number of things."""
        if not (token.isascii() and token.isdigit() and len(token) <= 12):
            raise MeshError(f"{self.where}: {token[:40]!r}; expected a number of things")
        return int(token)

    def take(self, count: int, kind: str) -> NDArray[Any]:
        """The next numbers, shape (count,)."""
        name = kind.lower()
        if name not in _TYPES:
            raise MeshError(f"{self.where}: numbers of type {kind[:40]!r}")
        dtype = np.dtype(">" + _TYPES[name])
        left = len(self._data) - self._at
        if not 0 <= count <= min(_MOST, left // (dtype.itemsize if self._binary else 1) + 1):
            raise MeshError(f"{self.where}: {count} numbers announced, {left} bytes follow")
        if self._binary:
            if count * dtype.itemsize > left:
                raise MeshError(f"{self.where}: {count} numbers announced, {left} bytes follow")
            found = np.frombuffer(self._data, dtype, count, self._at)
            self._at += count * dtype.itemsize
            return found
        return self._parse(count, dtype)

    def _parse(self, count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
        rest = self._data[self._at :]
        tokens = rest.split(None, count)
        if len(tokens) < count:
            raise MeshError(f"{self.where}: {count} numbers announced, {len(tokens)} follow")
        tail = tokens.pop() if len(tokens) > count else b""
        self._at = len(self._data) - len(tail)
        try:
            if dtype.kind == "f":
                return np.array([float(token) for token in tokens], dtype=np.float64)
            return np.array([int(token) for token in tokens], dtype=np.int64)
        except (ValueError, OverflowError):
            raise MeshError(f"{self.where}: a section of numbers holds what is none") from None


def starts(words: list[str], keyword: str) -> bool:
    """Whether a line starts with a keyword, in letters of either case."""
    return bool(words) and words[0].upper() == keyword
