"""Mesh files of bounded size as bytes and text, and the numbers in them."""

from __future__ import annotations

import stat
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...arrays import FloatArray
from ...errors import MeshError
from ...file_text import UNFETCHED, decode, is_lfs_pointer
from ..limits import MAX_COORDINATE

MAX_FILE_BYTES = 1 << 27
"""Largest mesh file that is opened [bytes]: 128 MiB, about two million nodes."""


def load_bytes(path: Path) -> bytes:
    """Read a whole mesh file.

    Raises:
        MeshError: If the file is missing, not a regular file, unreadable, too large, or was not fetched
            from Git LFS.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise MeshError(f"{path}: not a regular file")
        if status.st_size > MAX_FILE_BYTES:
            raise MeshError(
                f"{path}: {status.st_size} bytes; mesh files up to {MAX_FILE_BYTES} bytes are read"
            )
        data = path.read_bytes()
    except FileNotFoundError:
        raise MeshError(f"{path}: no such mesh file") from None
    except (OSError, ValueError) as error:
        raise MeshError(f"{path}: cannot be read ({error})") from error
    if is_lfs_pointer(data):
        raise MeshError(f"{path}:1: {UNFETCHED}")
    return data


def load_text(path: Path) -> str:
    """Read a whole text mesh file; bytes that are no text become U+FFFD and fail where they stand."""
    return decode(load_bytes(path), "replace")


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
        comma = ", with a decimal point" if "," in token else ""
        raise MeshError(
            f"{where}: coordinate {token[:40]!r}; expected a finite number up to {MAX_COORDINATE:g} m{comma}"
        )
    return value


def in_space(
    nodes: Sequence[Sequence[float]], lines: Sequence[int], where: str
) -> tuple[FloatArray, tuple[str, ...]]:
    """Nodes as an array, shape (N, 3), and what was done: a mesh of the plane gets z = 0.

    Args:
        nodes: Two or three coordinates each.
        lines: Line of each node.
        where: File, for messages.

    Raises:
        MeshError: If some nodes have two coordinates and others three.
    """
    flat = [len(node) == 2 for node in nodes]
    if not any(flat):
        return np.array(nodes, dtype=np.float64).reshape(-1, 3), ()
    if not all(flat):
        first = flat.index(True)
        raise MeshError(f"{where}:{lines[first]}: node {first + 1} has two coordinates, others three")
    plane = np.array(nodes, dtype=np.float64)
    return np.pad(plane, ((0, 0), (0, 1))), ("The nodes have two coordinates; z = 0.",)


def parse_int(token: str, where: str) -> int:
    """Convert one node number.

    Raises:
        MeshError: Naming the place, the token and what would be right.
    """
    digits = token[1:] if token[:1] in ("+", "-") else token
    if not (digits.isascii() and digits.isdigit() and len(digits) <= 18):
        raise MeshError(f"{where}: node number {token[:40]!r}; expected a whole number")
    return int(token)
