"""What the scenario promised against what the run gave."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Self

from ..frozen import frozen
from ..output.jsonable import Json, to_json
from ..quantities import with_unit
from ..run.loop import Outcome
from ..run.observables.reduce import reduce_series
from ..scenario.language.expect import Expectation, measured
from ..units import KINDS


@frozen
class Verdict:
    """One expectation, judged.

    Attributes:
        name: Its name.
        measured: What the run gave; NaN if it gave nothing.
        expected: What it should be.
        tolerance: Greatest deviation, as text.
        unit: SI unit of both numbers.
        source: Where the expected value comes from.
        passed: Whether they agree.
    """

    name: str
    measured: float
    expected: float
    tolerance: str
    unit: str
    source: str
    passed: bool

    @classmethod
    def of_json(cls, entry: Mapping[str, Json]) -> Self:
        """The verdict that :meth:`as_json` gave.

        Raises:
            ValueError: If it did not give this.
        """
        texts = {name: str(entry.get(name, "")) for name in ("name", "tolerance", "unit", "source")}
        measured, expected = (float(str(entry.get(name))) for name in ("measured", "expected"))
        return cls(measured=measured, expected=expected, passed=entry.get("passed") is True, **texts)

    def as_json(self) -> dict[str, Json]:
        """For programs and records."""
        return {name: to_json(value) for name, value in asdict(self).items()}

    def __str__(self) -> str:
        measured, expected = (with_unit(f"{x:.6g}", self.unit) for x in (self.measured, self.expected))
        word = "kept" if self.passed else "missed"
        promised = f"expected {expected} within {self.tolerance} ({self.source})"
        return f"{self.name} {word}: measured {measured}, {promised}"


def judge(expectations: Mapping[str, Expectation], outcome: Outcome) -> tuple[Verdict, ...]:
    """Measure every expectation on the watched series of a finished run."""
    verdicts = []
    for name, e in expectations.items():
        value = reduce_series(outcome.times, outcome.watched[name], e.reduce, at=e.at, after=e.after)
        unit = KINDS[measured(e.probe, e.reduce)].unit
        percent = e.tolerance.kind == "relative"
        tolerance = (
            f"{100.0 * e.tolerance.size:.6g} %" if percent else with_unit(f"{e.tolerance.size:.6g}", unit)
        )
        passed = e.tolerance.allows(value, e.value)
        verdicts.append(Verdict(name, value, e.value, tolerance, unit, e.source, passed))
    return tuple(verdicts)
