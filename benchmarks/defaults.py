"""Scenes that move: as shipped, as drafts, with large steps, with the default integrator."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from dismech_cli import load, simulate
from dismech_cli.run.loop import End
from dismech_cli.scenario.load import LoadedScenario
from dismech_cli.session.report import Report

from .scenes import SCENARIOS
from .table import table

DEFAULT = "numerics.integrator={type: tr_bdf2}"
COARSE = 4.0  # times the time step of the file


@dataclass(frozen=True, slots=True)
class Way:
    """One way to run a scene."""

    name: str
    coarse: float = 1.0
    default: bool = False
    profile: str | None = None

    def load(self, path: Path, dt: float) -> LoadedScenario:
        """The scene, run this way; ``dt`` is what its file says [s]."""
        overrides = [DEFAULT] if self.default else []
        if self.coarse != 1.0:
            overrides.append(f"numerics.dt={self.coarse * dt!r} s")
        return load(path, overrides=overrides, profile=self.profile)


WAYS = (
    Way("as shipped"),
    Way("draft", profile="draft"),
    Way("dt x 4", coarse=COARSE),
    Way("default", default=True),
    Way("default, dt x 4", default=True, coarse=COARSE),
)


def moving_scenes() -> Iterator[tuple[str, Path, float]]:
    """Name, file and time step [s] of the scenes that move."""
    for path in sorted([*SCENARIOS.glob("*.yaml"), *(SCENARIOS / "verification").glob("*.yaml")]):
        numerics = load(path).scenario.numerics
        if numerics.dt is not None:
            yield path.stem, path, float(numerics.dt)


def report(quick: bool) -> str:
    """Whether each run is finished, what it cost, the expectations it misses, what made it doubtful."""
    ways = WAYS[:2] if quick else WAYS
    rows = [(stem, 1e3 * dt, *(_cell(way, path, dt) for way in ways)) for stem, path, dt in moving_scenes()]
    return "\n\n".join(
        (
            "## Defaults that finish\n\n"
            "All scenes of the gallery that move, each run whole: as its file says, with `--profile draft`, "
            "with four times its time step, with the default integrator, and with both. Iterations of "
            "Newton's method and CPU seconds; *n of m* expectations missed, which are made for the scene as "
            "shipped; **failed** if the run did not come to its end; *doubts* where it said so itself:",
            table(("scene", "dt [ms]", *(way.name for way in ways)), rows),
        )
    )


def _cell(way: Way, path: Path, dt: float) -> str:
    start = time.process_time()
    done = simulate(way.load(path, dt))
    spent = time.process_time() - start
    return f"{_end(done)}{done.outcome.counters['iterations']} it, {spent:.2g} s{_marks(done)}"


def _end(done: Report) -> str:
    return "" if done.outcome.end is End.DONE else "**failed**: "


def _marks(done: Report) -> str:
    missed = [verdict for verdict in done.verdicts if not verdict.passed]
    marks = [f"{len(missed)} of {len(done.verdicts)} missed"] if missed else []
    marks += ["doubts"] if done.outcome.doubts else []
    return "".join(f"; {mark}" for mark in marks)
