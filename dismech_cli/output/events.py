"""What happened and when: one JSON object per line."""

from __future__ import annotations

import json
import os
from pathlib import Path

from ..errors import OutputError
from .durable import output_errors, size_up_to, write_fully
from .jsonable import Json, dumps


class EventLog:
    """Appends events to ``events.jsonl``; each is with the system when :meth:`add` returns.

    Args:
        path: The file; made when missing.
        resume_at: Drop the events with t > ``resume_at`` [s], which the resumed run will repeat;
            None appends to what is there.
    """

    def __init__(self, path: Path, resume_at: float | None = None) -> None:
        self._path = path
        with output_errors(path, "open"):
            if resume_at is not None and path.exists():
                with path.open("rb") as file:
                    size = size_up_to(path, file, resume_at, lambda line: float(json.loads(line)["t"]))
                os.truncate(path, size)
            self._file = path.open("ab", buffering=0)

    def add(self, kind: str, t: float, **details: object) -> None:
        """Append one event.

        Args:
            kind: What happened, e.g. ``"step_rejected"``.
            t: Simulated time [s].
            **details: Anything with a JSON form; NaN and infinity become strings.

        Raises:
            OutputError: If the line could not be written.
        """
        line = (dumps({"t": t, "kind": kind, **details}) + "\n").encode()
        with output_errors(self._path):
            write_fully(self._file, line)

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._file.close()


def read_events(path: Path) -> list[dict[str, Json]]:
    """Read all whole events; a last line that is cut is left out.

    Raises:
        OutputError: If the file cannot be read.
    """
    with output_errors(path, "read"):
        data = path.read_bytes()
    events = []
    for number, line in enumerate(data[: data.rfind(b"\n") + 1].splitlines(), start=1):
        try:
            events.append(json.loads(line))
        except ValueError as error:
            raise OutputError(f"cannot read {path}: line {number} is damaged") from error
    return events
