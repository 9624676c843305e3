"""What comes of a study: its runs with their errors, and the answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from ...frozen import frozen
from ...scenario.language.study import Measured
from .measure import Point
from .refine import Found
from .space import Setting


@frozen(kw_only=True)
class Row:
    """A run of the table.

    Attributes:
        point: The run.
        error: Its error, as far as known.
        best: Whether none is both cheaper and more accurate.
    """

    point: Point
    error: float | None
    best: bool


@frozen(kw_only=True)
class Studied:
    """What came of a study.

    Attributes:
        name: Of the scenario.
        folder: Where it lies.
        target: Largest error allowed.
        quantities: Whose errors counted.
        rows: All runs, the cheapest first.
        found: What each alternative came to that was worth it, the answer first.
        count: How many combinations there are.
        finer: The option that adds levels.
        missing: What was not refined, whose error comes on top: ``steps``, ``mesh``.
        reference: From what errors are measured.
        load: Mean number of busy cores of the machine as it ended; None if unknown.
    """

    name: str
    folder: Path
    target: float
    quantities: Mapping[str, Measured]
    rows: tuple[Row, ...]
    found: tuple[Found, ...]
    count: int
    finer: str
    missing: tuple[str, ...]
    reference: str
    load: float | None

    @property
    def answer(self) -> Found | None:
        """The setting that meets the target; None if none was found."""
        return self.found[0] if self.found and self.found[0].meets else None

    @property
    def told(self) -> str:
        """The outcome in a line or two."""
        if self.answer is None:
            why = self.found[0].reason if self.found else "no alternative is stable on these levels"
            return (
                f"no setting with an error below {self.target:.3g}: {why}; levels are added by {self.finer}"
            )
        one = self.answer
        shares = {"steps": one.time.error, "mesh": one.mesh.error}
        told = ", ".join(
            f"{name} not known, none finer was tried" if name in self.missing else f"{name} {share:.2g}"
            for name, share in shares.items()
        )
        doubts = "".join(f"\nthat run is doubtful: {doubt}" for doubt in one.point.doubts)
        return (
            f"error {one.error:.2g} ({told}) for {one.point.cpu:.2g} CPU s: {set_line(one.point.settings)}"
            f"{doubts}"
        )


def set_line(settings: Sequence[Setting]) -> str:
    """Settings as the command line takes them."""
    return " ".join(f"--set {key}={_quoted(text)}" for key, text in settings)


def _quoted(text: str) -> str:
    return text if text.replace(".", "").replace("-", "").replace("_", "").isalnum() else f"'{text}'"


COLUMNS: Final = (
    "settings",
    "status",
    "error",
    "best",
    "cpu [s]",
    "steps",
    "iterations",
    "cuts",
    "memory [MB]",
)


def cells(row: Row) -> tuple[object, ...]:
    """A row of the table."""
    one = row.point
    cpu = round(one.cpu, 4) if one.stable else None
    memory = round(one.memory / 1e6) if one.memory > 0.0 else None
    return one.label, one.status, row.error, row.best, cpu, one.steps, one.iterations, one.cuts, memory
