"""Columns of numbers from a CSV file."""

from __future__ import annotations

import csv
import math
import os
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from .arrays import FloatArray
from .errors import ScenarioError

MAX_BYTES: Final = 256 * 1024 * 1024


def read_columns(path: Path, columns: Sequence[str | int]) -> tuple[FloatArray, ...]:
    """Columns of a comma-separated file, chosen by the name in its first line or by number from 0.

    Blank lines and lines that start with ``#`` are skipped. A first line that is not all numbers
    names the columns.

    Args:
        path: The file.
        columns: Names or numbers.

    Returns:
        One array per column, shape (rows,), at least one row.

    Raises:
        ScenarioError: naming file and line, if the file cannot be read or a value is no finite number.
    """
    rows = _rows(path)
    if not rows:
        raise ScenarioError(f"{path}: holds no rows")
    header = [cell.strip() for cell in rows[0][1]]
    named = any(_number(cell) is None for cell in header)
    body = rows[1:] if named else rows
    if not body:
        raise ScenarioError(f"{path}: holds no rows of numbers")
    indices = [_index(path, column, header if named else None, len(header)) for column in columns]
    table = np.empty((len(indices), len(body)))
    for i, (line, cells) in enumerate(body):
        for k, index in enumerate(indices):
            value = _number(cells[index]) if index < len(cells) else None
            if value is None:
                shown = cells[index].strip()[:40] if index < len(cells) else "nothing"
                raise ScenarioError(
                    f"{path}:{line}: column {columns[k]}: expected a finite number, got {shown!r}"
                )
            table[k, i] = value
    return tuple(table)


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    try:
        mode = path.stat()
        if not stat.S_ISREG(mode.st_mode):
            raise ScenarioError(f"{path}: not a regular file")
        if mode.st_size > MAX_BYTES:
            raise ScenarioError(f"{path}: larger than {MAX_BYTES // 1024**2} MB")
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(line for line in file if not line.startswith("#"))
            return [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = (
            os.strerror(error.errno).lower()
            if isinstance(error, OSError) and error.errno
            else "not a CSV text"
        )
        raise ScenarioError(f"{path}: cannot read: {reason}") from None


def _index(path: Path, column: str | int, header: list[str] | None, width: int) -> int:
    if isinstance(column, int):
        if column >= width:
            raise ScenarioError(f"{path}: has no column {column}: there are {width}, counted from 0")
        return column
    if header is None:
        raise ScenarioError(f"{path}: its first line names no columns, but column {column!r} is asked for")
    if column not in header:
        raise ScenarioError(f"{path}: has no column {column!r}; there are {', '.join(header)}")
    return header.index(column)


def _number(cell: str) -> float | None:
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
