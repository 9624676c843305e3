"""A scene at an extreme, and the two ways in which it may end."""

from __future__ import annotations

import json
import re
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Final

import numpy as np

from dismech_cli import load, simulate
from dismech_cli.run.loop import End
from dismech_cli.session.report import Report

Deck = Mapping[str, Any]
Check = Callable[[Report], str]
"""What is wrong with a run that came to its end; empty if nothing is."""


class Kind(Enum):
    """How a cell ended."""

    RIGHT = "converged and right"
    NAMED = "exit 3, named"
    WRONG = "neither"


@dataclass(frozen=True, slots=True)
class Cell:
    """A scene at an extreme.

    Attributes:
        family: What it is one of.
        label: What is extreme.
        deck: The scene.
        check: Looks at a run that came to its end.
    """

    family: str
    label: str
    deck: Deck
    check: Check

    def __str__(self) -> str:
        return f"{self.family}: {self.label}"


@dataclass(frozen=True, slots=True)
class Verdict:
    """How a cell ended.

    Attributes:
        cell: Which.
        kind: How.
        why: The reason that the program named, or what is wrong.
        seconds: CPU time, composing included [s].
    """

    cell: Cell
    kind: Kind
    why: str
    seconds: float


# First lines of runs that gave up, and the reason in them: all else counts as neither.
_REASONS: Final = (
    re.compile(r"the solver gave up at .*: (.+)"),
    re.compile(r"(the motion blew up) by t = "),
    re.compile(r"(the [\w, ]+ energy is infinite or not a number) at t = "),
)


def judged(cell: Cell) -> Verdict:
    """Run a cell. Whatever it raises is a fault of the program."""
    began = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.yaml"
        file.write_text(json.dumps(dict(cell.deck), default=lambda array: array.tolist()), encoding="utf-8")
        report = simulate(load(file))
    kind, why = _ending(cell, report)
    return Verdict(cell, kind, why, time.process_time() - began)


def _ending(cell: Cell, report: Report) -> tuple[Kind, str]:
    for frame in report.frames:
        if not (np.isfinite(frame.positions).all() and np.isfinite(list(frame.scalars.values())).all()):
            return Kind.WRONG, f"frame {frame.index} is not finite"
    if report.outcome.end is End.DONE:
        wrong = cell.check(report)
        return (Kind.WRONG, wrong) if wrong else (Kind.RIGHT, "")
    first = report.outcome.message.partition("\n")[0]
    named = next((found for one in _REASONS if (found := one.match(first))), None)
    return (Kind.NAMED, named[1]) if named else (Kind.WRONG, first)


def near(found: float, expected: float, share: float, what: str) -> str:
    """What is wrong with a number that is to be another within a share of it; empty if nothing is."""
    if abs(found - expected) <= share * abs(expected):
        return ""
    return f"{what} {found:.6g} for {expected:.6g}"
