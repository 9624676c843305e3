"""All scenes of the gallery: as shipped, as drafts, with large steps, with the default integrator."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from dismech_cli import load, simulate
from dismech_cli.errors import DismechError
from dismech_cli.run.loop import End
from dismech_cli.scenario.language.numerics import Numerics, Static
from dismech_cli.scenario.language.scenario import Scenario
from dismech_cli.scenario.load import LoadedScenario
from dismech_cli.session.report import Report

from .scenes import SCENARIOS
from .table import table

DEFAULT = "numerics.integrator={type: tr_bdf2}"
COARSE = 4.0  # times the time step of the file
LONGEST = 300.0  # processor time after which a run is given up [s]


@dataclass(frozen=True, slots=True)
class Way:
    """One way to run a scene."""

    name: str
    coarse: float = 1.0
    default: bool = False
    profile: str | None = None

    def fits(self, numerics: Numerics) -> bool:
        """Whether a scene can be run this way: statics have no integrator to choose, some scenes no step."""
        still = isinstance(numerics.integrator, Static)
        return not (still and self.default) and not (self.coarse != 1.0 and numerics.dt is None)

    def load(self, path: Path, numerics: Numerics) -> LoadedScenario:
        """The scene, run this way; ``numerics`` are those of its file."""
        overrides = [DEFAULT] if self.default else []
        if self.coarse != 1.0 and numerics.dt is not None:
            overrides.append(f"numerics.dt={self.coarse * numerics.dt!r} s")
        return load(path, overrides=overrides, profile=self.profile)


WAYS = (
    Way("as shipped"),
    Way("draft", profile="draft"),
    Way("dt x 4", coarse=COARSE),
    Way("default", default=True),
    Way("default, dt x 4", default=True, coarse=COARSE),
)


def scenes() -> Iterator[Path]:
    """Files of the scenes."""
    yield from sorted([*SCENARIOS.glob("*.yaml"), *(SCENARIOS / "verification").glob("*.yaml")])


def report(quick: bool) -> str:
    """Whether each run is finished, what it cost, the expectations it misses, what made it doubtful."""
    ways = WAYS[:2] if quick else WAYS
    rows = []
    for path in scenes():
        rows.append(_row(path, ways))
        # the whole takes long: what is measured is seen
        print("|", " | ".join(rows[-1]), "|", flush=True)
    return page(ways, rows)


def page(ways: Sequence[Way], rows: Sequence[Sequence[str]]) -> str:
    """The table of what was measured, under what it means."""
    return "\n\n".join(
        (
            "## Defaults that finish\n\n"
            "All scenes of the gallery, each run whole: as its file says, with `--profile draft`, with four "
            "times its time step, with the default integrator, and with both; *same* where that changes "
            "nothing, a dash where there is no step or integrator to change. Iterations of Newton's method "
            "and CPU seconds; *n of m* expectations missed, which are made for the scene as shipped; "
            "**failed** if the run did not come to its end, "
            f"**stopped** after {LONGEST:g} s; *doubts* where it said so itself:",
            table(("scene", "dt [ms]", *(way.name for way in ways)), rows),
        )
    )


def _row(path: Path, ways: tuple[Way, ...]) -> list[str]:
    numerics = load(path).scenario.numerics
    row = [path.stem, "" if numerics.dt is None else f"{1e3 * numerics.dt:.3g}"]
    done: list[Scenario] = []
    for way in ways:
        if not way.fits(numerics):
            row.append("–")
            continue
        loaded = way.load(path, numerics)
        row.append("same" if loaded.scenario in done else _cell(loaded))
        done.append(loaded.scenario)
    return row


def _cell(loaded: LoadedScenario) -> str:
    start = time.process_time()
    try:
        with _within(LONGEST):
            done = simulate(loaded)
    except DismechError as error:
        return f"**refused**: {str(error).splitlines()[0]}"
    except TimeoutError:
        return "**stopped**"
    spent = time.process_time() - start
    return f"{_end(done)}{done.outcome.counters['iterations']} it, {spent:.2g} s{_marks(done)}"


@contextmanager
def _within(seconds: float) -> Iterator[None]:
    """Stop the block after so much processor time [s]."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _end(done: Report) -> str:
    return "" if done.outcome.end is End.DONE else "**failed**: "


def _marks(done: Report) -> str:
    missed = [verdict for verdict in done.verdicts if not verdict.passed]
    marks = [f"{len(missed)} of {len(done.verdicts)} missed"] if missed else []
    marks += ["doubts"] if done.outcome.doubts else []
    return "".join(f"; {mark}" for mark in marks)
