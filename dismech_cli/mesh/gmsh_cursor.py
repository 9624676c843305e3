"""Reading the numbers of a gmsh section in file order, as text or as bytes, never past its end."""

from __future__ import annotations

from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..errors import MeshError

_LONGEST_TOKEN = 64


class Cursor(Protocol):
    """Takes numbers one run after another; what is not there is a MeshError before allocation."""

    position: int

    def ints(self, count: int) -> IntArray:
        """Take 32-bit integers, shape (count,)."""

    def sizes(self, count: int) -> IntArray:
        """Take counts or tags (gmsh's size_t), shape (count,)."""

    def doubles(self, count: int) -> FloatArray:
        """Take real numbers, shape (count,)."""

    def place(self, position: int) -> str:
        """Name a position for messages."""

    def lines(self, positions: IntArray) -> IntArray | None:
        """Line numbers of positions, None in binary files."""


class TextCursor:
    """The whitespace-separated tokens of a text section."""

    def __init__(self, body: bytes, first_line: int, where: str) -> None:
        self.position = 0
        self._where = where
        self._tokens: list[bytes] = []
        counts = []
        for line in body.split(b"\n"):
            tokens = line.split()
            self._tokens += tokens
            counts.append(len(tokens))
        self._lines = np.repeat(np.arange(len(counts)) + first_line, counts)
        self._last_line = first_line + len(counts) - 1

    def ints(self, count: int) -> IntArray:
        """Take integers, shape (count,)."""
        return self._take(count, np.int64, "a whole number")

    def sizes(self, count: int) -> IntArray:
        """Take integers, shape (count,)."""
        return self._take(count, np.int64, "a whole number")

    def doubles(self, count: int) -> FloatArray:
        """Take real numbers, shape (count,)."""
        return self._take(count, np.float64, "a number")

    def place(self, position: int) -> str:
        """Name the line of a token."""
        line = self._lines[position] if position < len(self._lines) else self._last_line
        return f"{self._where}:{line}"

    def lines(self, positions: IntArray) -> IntArray:
        """Line numbers of tokens."""
        return self._lines[positions]

    def _take(self, count: int, dtype: type[Any], expected: str) -> NDArray[Any]:
        start = self.position
        if not 0 <= count <= len(self._tokens) - start:
            raise MeshError(
                f"{self.place(start)}: {count} numbers announced, "
                f"{len(self._tokens) - start} follow in the section"
            )
        tokens = self._tokens[start : start + count]
        self.position += count
        try:
            # A long token would be cut to the width of the array's entries.
            if max(map(len, tokens), default=0) > _LONGEST_TOKEN:
                raise ValueError
            return np.array(tokens, dtype=f"S{_LONGEST_TOKEN}").astype(dtype)
        except (ValueError, OverflowError):
            raise self._bad_token(start, tokens, dtype, expected) from None

    def _bad_token(self, start: int, tokens: list[bytes], dtype: type[Any], expected: str) -> MeshError:
        offset = next(k for k, token in enumerate(tokens) if not _converts(token, dtype))
        text = tokens[offset][:40].decode("ascii", errors="replace")
        return MeshError(f"{self.place(start + offset)}: {text!r}; expected {expected}")


def _converts(token: bytes, dtype: type[Any]) -> bool:
    try:
        np.array([token], dtype=f"S{_LONGEST_TOKEN}").astype(dtype)
    except (ValueError, OverflowError):
        return False
    return len(token) <= _LONGEST_TOKEN


class ByteCursor:
    """The little-endian bytes of a binary section."""

    def __init__(self, data: bytes, position: int, size_bytes: Literal[4, 8], where: str) -> None:
        self.position = position
        self._data = data
        self._size = f"<u{size_bytes}"
        self._where = where

    def ints(self, count: int) -> IntArray:
        """Take 32-bit integers, shape (count,)."""
        return self._take(count, "<i4").astype(np.int64)

    def sizes(self, count: int) -> IntArray:
        """Take unsigned integers, shape (count,); those past int64 turn negative and fail later."""
        return self._take(count, self._size).astype(np.int64)

    def doubles(self, count: int) -> FloatArray:
        """Take real numbers, shape (count,)."""
        return self._take(count, "<f8").astype(np.float64)

    def place(self, position: int) -> str:
        """Name the offset of a byte."""
        return f"{self._where}: byte {position}"

    def lines(self, positions: IntArray) -> None:
        """Binary sections have no lines."""
        return

    def _take(self, count: int, dtype: str) -> NDArray[Any]:
        width = np.dtype(dtype).itemsize
        left = len(self._data) - self.position
        if not 0 <= count * width <= left:
            raise MeshError(
                f"{self.place(self.position)}: {count} numbers announced, {left} bytes follow in the file"
            )
        values = np.frombuffer(self._data, dtype, count, self.position)
        self.position += count * width
        return values
