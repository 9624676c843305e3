"""Columns of numbers from a table in a text file."""

from __future__ import annotations

import csv
import math
import os
import stat
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from .arrays import FloatArray
from .errors import ScenarioError
from .file_text import UNFETCHED, decode, is_lfs_pointer
from .frozen import frozen

MAX_BYTES: Final = 256 * 1024 * 1024
_PARTED: Final[Mapping[str | None, str]] = {
    ",": "commas",
    ";": "semicolons",
    "\t": "tabs",
    None: "blanks",
}
_MISSING: Final = ("", "nan", "na")


@frozen
class _Row:
    """The cells of a line, counted from 1."""

    line: int
    cells: list[str]


@frozen
class _Table:
    """The rows of a file, and what parts their cells.

    Attributes:
        path: The file.
        separator: A character, or None for blanks.
        rows: At least one, comments and blank lines left out.
    """

    path: Path
    separator: str | None
    rows: list[_Row]

    def number(self, cell: str) -> float | None:
        """The finite number in a cell, or None; a decimal comma counts where commas part nothing."""
        if self.separator != "," and cell.count(",") == 1 and "." not in cell:
            cell = cell.replace(",", ".")
        try:
            value = float(cell) if "_" not in cell else math.nan
        except ValueError:
            return None
        return value if math.isfinite(value) else None


def read_columns(path: Path, columns: Sequence[str | int], *, gaps: bool = False) -> tuple[FloatArray, ...]:
    """Columns of a table, chosen by the name in its first line or by number from 0.

    Commas, semicolons, tabs or blanks part the cells, as the first line shows; with semicolons, tabs or
    blanks, numbers may have a decimal comma. Blank lines and lines that start with ``#`` are skipped. A
    first line that is not all numbers names the columns.

    Args:
        path: The file.
        columns: Names or numbers.
        gaps: Whether cells may be empty, or ``nan``, which gives NaN.

    Returns:
        One array per column, shape (rows,), at least one row.

    Raises:
        ScenarioError: naming file and line, if the file cannot be read or a value is no finite number.
    """
    table = _table(path)
    header = [cell.strip() for cell in table.rows[0].cells]
    named = any(table.number(cell) is None for cell in header)
    body = table.rows[1:] if named else table.rows
    if not body:
        raise ScenarioError(f"{path}: holds no rows of numbers")
    indices = [_index(table, column, header if named else None, len(header)) for column in columns]
    numbers = np.empty((len(indices), len(body)))
    for i, row in enumerate(body):
        for k, index in enumerate(indices):
            cell = row.cells[index] if index < len(row.cells) else ""
            value = table.number(cell)
            if value is None and gaps and cell.strip().lower() in _MISSING:
                value = math.nan
            if value is None:
                shown = cell.strip()[:40] if index < len(row.cells) else "nothing"
                raise ScenarioError(
                    f"{path}:{row.line}: column {columns[k]}: expected a finite number, got {shown!r} "
                    f"(cells are parted by {_PARTED[table.separator]})"
                )
            numbers[k, i] = value
    return tuple(numbers)


def _table(path: Path) -> _Table:
    try:
        mode = path.stat()
        if not stat.S_ISREG(mode.st_mode):
            raise ScenarioError(f"{path}: not a regular file")
        if mode.st_size > MAX_BYTES:
            raise ScenarioError(f"{path}: larger than {MAX_BYTES // 1024**2} MB")
        data = path.read_bytes()
        if is_lfs_pointer(data):
            raise ScenarioError(f"{path}:1: {UNFETCHED}")
        lines = list(enumerate(decode(data).split("\n"), start=1))
        told = [(number, line) for number, line in lines if line.strip() and not line.startswith("#")]
        separator = _separator(told[0][1]) if told else None
        # A row at a time: a quote that is never closed spoils its own line alone.
        cells = ((number, _cells(line, separator)) for number, line in told)
        rows = [_Row(number, row) for number, row in cells if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = (
            os.strerror(error.errno).lower()
            if isinstance(error, OSError) and error.errno
            else "not a CSV text"
        )
        raise ScenarioError(f"{path}: cannot read: {reason}") from None
    if not rows:
        raise ScenarioError(f"{path}: holds no rows")
    return _Table(path, separator, rows)


def _separator(line: str) -> str | None:
    """What parts the cells of a line; a comma beside a semicolon or a tab is a decimal comma."""
    return next((mark for mark in (";", "\t", ",") if mark in line), None)


def _cells(line: str, separator: str | None) -> list[str]:
    return line.split() if separator is None else next(csv.reader([line], delimiter=separator), [])


def _index(table: _Table, column: str | int, header: list[str] | None, width: int) -> int:
    path = table.path
    if isinstance(column, int):
        if column >= width:
            raise ScenarioError(
                f"{path}:{table.rows[0].line}: has no column {column}: there are {width}, counted from 0, "
                f"parted by {_PARTED[table.separator]}"
            )
        return column
    if header is None:
        raise ScenarioError(f"{path}: its first line names no columns, but column {column!r} is asked for")
    if column not in header:
        raise ScenarioError(f"{path}: has no column {column!r}; there are {', '.join(header)}")
    return header.index(column)
