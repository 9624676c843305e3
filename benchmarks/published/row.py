"""One number of the literature and what the program gives for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Final, Protocol

from dismech_cli import load, simulate
from dismech_cli.session.verdicts import Verdict

SCENARIOS: Final = Path(__file__).parents[2] / "scenarios"


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the table.

    Attributes:
        command: That runs the scenario, with what is set in it.
        quantity: Name of the expectation, or of what was sought.
        published: The number.
        here: What the program gives; NaN if it gives nothing.
        unit: SI unit of both.
        tolerance: Greatest deviation, as text.
        source: Of the published number.
        met: Whether they agree.
    """

    command: str
    quantity: str
    published: float
    here: float
    unit: str
    tolerance: str
    source: str
    met: bool

    @property
    def deviation(self) -> str:
        """Of the published number; in its unit where that is zero."""
        if self.published:
            return f"{100.0 * (self.here / self.published - 1.0):.2g} %"
        return f"{self.here - self.published:.2g} {self.unit}".strip()


class Case(Protocol):
    """A scenario that gives rows."""

    def rows(self) -> list[Row]:
        """Run it."""
        ...


def command(file: str, changes: tuple[str, ...]) -> str:
    """The line that runs a scenario of the gallery."""
    return " ".join([f"dismech run scenarios/{file}.yaml", *(f"--set {quote(one)}" for one in changes)])


class RunError(Exception):
    """A scenario did not come to its end."""


def verdicts(file: str, changes: tuple[str, ...]) -> tuple[Verdict, ...]:
    """Run a scenario of the gallery and judge what it promises.

    Raises:
        RunError: It does not come to its end.
    """
    report = simulate(load(SCENARIOS / f"{file}.yaml", overrides=changes))
    if not report.verdicts:
        raise RunError(f"{file} {' '.join(changes)}: {report.message or 'it promises nothing'}")
    return report.verdicts
