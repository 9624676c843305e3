"""Where a mesh comes from: bounded reading of files, and the lines that error messages name."""

from __future__ import annotations

import stat
from dataclasses import dataclass
from pathlib import Path

from ...arrays import IntArray
from ...errors import MeshError

MAX_FILE_BYTES = 1 << 27
"""Largest mesh file that is opened [bytes]: 128 MiB, about two million nodes."""

MAX_COUNT = 2_000_000
"""Largest number of nodes, edges or triangles of one mesh."""

MAX_COORDINATE = 1e12
"""Largest coordinate [m]; beyond it, products of coordinates lose all meaning."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Lines:
    """Line numbers (from 1) of the entries of a mesh file; None where there are none.

    Attributes:
        nodes: Shape (N,).
        edges: Shape (E,).
        triangles: Shape (T,).
    """

    nodes: IntArray | None = None
    edges: IntArray | None = None
    triangles: IntArray | None = None


def load_bytes(path: Path) -> bytes:
    """Read a whole mesh file.

    Raises:
        MeshError: If the file is missing, not a regular file, unreadable or too large.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise MeshError(f"{path}: not a regular file")
        if status.st_size > MAX_FILE_BYTES:
            raise MeshError(
                f"{path}: {status.st_size} bytes; mesh files up to {MAX_FILE_BYTES} bytes are read"
            )
        return path.read_bytes()
    except FileNotFoundError:
        raise MeshError(f"{path}: no such mesh file") from None
    except (OSError, ValueError) as error:
        raise MeshError(f"{path}: cannot be read ({error})") from error


def load_text(path: Path) -> str:
    """Read a whole text mesh file; bytes that are not UTF-8 become U+FFFD and fail where they stand."""
    return load_bytes(path).decode("utf-8-sig", errors="replace")


def check_count(count: int, what: str, where: str) -> int:
    """Return ``count`` if a mesh may have that many, before anything is allocated for it.

    Raises:
        MeshError: If the count is negative or above :data:`MAX_COUNT`.
    """
    if not 0 <= count <= MAX_COUNT:
        raise MeshError(f"{where}: {count} {what}; a mesh may have 0 to {MAX_COUNT}")
    return count


def parse_float(token: str, where: str) -> float:
    """Convert one coordinate; NaN, infinities and Python's underscores are refused.

    Raises:
        MeshError: Naming the place, the token and what would be right.
    """
    try:
        value = float(token) if "_" not in token else float("nan")
    except ValueError:
        value = float("nan")
    if not abs(value) <= MAX_COORDINATE:
        raise MeshError(
            f"{where}: coordinate {token[:40]!r}; expected a finite number up to {MAX_COORDINATE:g} m"
        )
    return value


def parse_int(token: str, where: str) -> int:
    """Convert one node number.

    Raises:
        MeshError: Naming the place, the token and what would be right.
    """
    digits = token[1:] if token[:1] in ("+", "-") else token
    if not (digits.isascii() and digits.isdigit() and len(digits) <= 18):
        raise MeshError(f"{where}: node number {token[:40]!r}; expected a whole number")
    return int(token)
