"""Scalars over time as a CSV file that a spreadsheet, pandas or gnuplot reads."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import IO

import numpy as np

from ..arrays import FloatArray
from ..errors import OutputError
from .durable import output_errors, size_up_to, write_fully
from .frame import Frame, Topology


class CsvWriter:
    """Appends one line per frame or step; they are with the system when the call returns.

    Args:
        path: The file, usually ``scalars.csv``.
        resume_at: Keep the rows with t <= ``resume_at`` [s] and continue; None makes a new file.
    """

    def __init__(self, path: Path, resume_at: float | None = None) -> None:
        self._path = path
        self._resume_at = resume_at
        self._names: tuple[str, ...] = ()
        self._file: IO[bytes] | None = None

    def open(self, topology: Topology, metadata: Mapping[str, str]) -> None:
        """Write the header ``t [s],name [unit],...``, or cut a file that exists.

        Raises:
            OutputError: If the file exists (new run), or is missing or has other columns (resume).
        """
        self._names = tuple(name for name in topology.scalars if name != "t")
        header = _header(["t [s]", *(f"{name} [{topology.scalars[name]}]" for name in self._names)])
        if self._resume_at is None:
            with output_errors(self._path, "create"):
                self._file = self._path.open("xb", buffering=0)
            self._append(header)
        else:
            with output_errors(self._path, "resume"):
                size = _kept(self._path, header, self._resume_at)
                self._file = self._path.open("r+b", buffering=0)
                self._file.truncate(size)
                self._file.seek(size)

    def write(self, *frames: Frame) -> None:
        """Append the scalars of frames.

        Raises:
            OutputError: If a line could not be written; lines before it are kept.
        """
        self._append(b"".join(self._row(frame.t, frame.scalars) for frame in frames))

    def write_row(self, t: float, scalars: Mapping[str, float]) -> None:
        """Append one row, for runs that log every step and not only frames.

        Args:
            t: Time [s].
            scalars: One value for every scalar of the topology.

        Raises:
            OutputError: If the line could not be written.
        """
        self._append(self._row(t, scalars))

    def _row(self, t: float, scalars: Mapping[str, float]) -> bytes:
        return (
            ",".join([repr(float(t)), *(repr(float(scalars[name])) for name in self._names)]) + "\n"
        ).encode()

    def _append(self, lines: bytes) -> None:
        if self._file is None:
            raise ValueError("write before open")
        with output_errors(self._path):
            # The file is unbuffered: lines are one call of the system, and a failure shows at once.
            write_fully(self._file, lines)

    def close(self) -> None:
        """Close the file; safe to call twice.

        Raises:
            OutputError: If the last bytes could not be written.
        """
        if self._file is not None:
            with output_errors(self._path, "close"):
                self._file.close()
            self._file = None


def _header(cells: list[str]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode()


def _kept(path: Path, header: bytes, t: float) -> int:
    """Bytes of the header and of the whole rows with time up to ``t``."""
    with path.open("rb") as file:
        if file.readline() != header:
            raise OutputError(f"cannot resume {path}: its header is not '{header.decode().strip()}'")
        return len(header) + size_up_to(path, file, t, lambda line: float(line.split(b",", 1)[0]))


def read_table(path: Path) -> tuple[dict[str, FloatArray], dict[str, str]]:
    """Read a table back, without a last line that is cut.

    Returns:
        The columns by name, each of shape (rows,), and their units by name.

    Raises:
        OutputError: If the file is missing, or a line has no or too many numbers.
    """
    with output_errors(path, "read"):
        text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    rows = list(csv.reader(io.StringIO(whole)))
    if not rows:
        raise OutputError(f"cannot read {path}: it has no header")
    names, units = [], {}
    for cell in rows[0]:
        name, _, unit = cell.rpartition(" [")
        names.append(name)
        units[name] = unit.removesuffix("]")
    values = np.empty((len(rows) - 1, len(names)))
    for number, row in enumerate(rows[1:]):
        try:
            values[number] = [float(cell) for cell in row]
        except ValueError as error:
            raise OutputError(f"{path}:{number + 2}: expected {len(names)} numbers, got {row!r}") from error
    return {name: values[:, column].copy() for column, name in enumerate(names)}, units
