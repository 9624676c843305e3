"""How a run ended: its exit code, one message, and the verdicts on what it promised."""

from __future__ import annotations

from collections.abc import Iterator
from shlex import quote

from ..frozen import frozen
from ..run.interrupt import StopRequest
from ..run.loop import End, Limits, Outcome
from ..run.tolerance import RTOL
from ..scenario.language.scenario import Scenario
from ..scenario.load import LoadedScenario
from .exit_codes import Exit
from .narrator import Narrator
from .verdicts import Verdict, judge

# Iterations of a step from which on two steps of half its length usually take fewer; not told of a few steps.
_MANY, _SOME = 8.0, 20
# Overrides of what is written and of what is expected change no number.
_HARMLESS = ("output", "expect", "name")


@frozen
class Ending:
    """The end of a run.

    Attributes:
        code: Exit code of the program.
        message: Empty if all is well.
        verdicts: One per expectation, if the run came to its end.
    """

    code: int
    message: str
    verdicts: tuple[Verdict, ...] = ()


def conclude(
    loaded: LoadedScenario,
    outcome: Outcome,
    limits: Limits,
    stop: StopRequest,
    narrator: Narrator,
    advice: str,
) -> Ending:
    """Judge a run and tell how it ended.

    Args:
        loaded: What was promised.
        outcome: What was given.
        limits: When the run was to pause.
        stop: Whether a signal stopped it.
        narrator: Told.
        advice: How to go on where the run did not end, or nothing.
    """
    for doubt in outcome.doubts:
        narrator.warn(doubt)
    if laborious := _laborious(loaded.scenario, outcome):
        narrator.say(laborious)
    match outcome.end:
        case End.FAILED:
            narrator.error("\n  ".join(filter(None, (outcome.message, advice))))
            return Ending(Exit.SOLVER, outcome.message)
        case End.INTERRUPTED:
            message = f"{outcome.message} at t = {outcome.state.t:.6g} s"
            narrator.say("; ".join(filter(None, (message, advice))))
            return Ending(_pause_code(limits, outcome, stop), message)
        case End.DONE:
            verdicts = judge(loaded.scenario.expect, outcome)
            missed = [v for v in verdicts if not v.passed]
            if not missed:
                return Ending(Exit.DONE, "", verdicts)
            for verdict in missed:
                narrator.warn(str(verdict))
            for hint in _hints(loaded):
                narrator.say(hint)
            names = ", ".join(verdict.name for verdict in missed)
            narrator.error(f"expectation missed: {names}")
            return Ending(Exit.EXPECTATION, f"missed: {names}", verdicts)


def _hints(loaded: LoadedScenario) -> Iterator[str]:
    """What may be the matter with a run that misses what its file promises."""
    profile = [] if loaded.profile is None else [f"--profile {loaded.profile}"]
    changes = [
        *profile,
        *(f"--set {quote(one)}" for one in loaded.overrides if not one.startswith(_HARMLESS)),
    ]
    if changes:
        yield (
            f"expected values are those of the file as written; changed here: {', '.join(changes)}. "
            "One whose source names a step or a mesh holds for that alone"
        )
    numerics = loaded.scenario.numerics
    if numerics.adapts:
        rtol = 0.1 * (numerics.step.rtol or RTOL)
        yield f"are steps fine enough? A tenth of their tolerance tells: --set numerics.step.rtol={rtol:.3g}"


def _laborious(scenario: Scenario, outcome: Outcome) -> str:
    """That steps are so long that shorter ones cost less; empty if they are not."""
    numerics, counts = scenario.numerics, outcome.counters
    steps, iterations = counts["steps"], counts["iterations"]
    if numerics.dt is None or numerics.adapts or steps < _SOME or iterations <= _MANY * steps:
        return ""
    return (
        f"{iterations / steps:.1f} Newton iterations per step, {counts['cuts']} cuts in {steps} steps: half "
        f"the step is likely cheaper, and more accurate: --set numerics.dt='{0.5 * numerics.dt:.3g} s'"
    )


def _pause_code(limits: Limits, outcome: Outcome, stop: StopRequest) -> int:
    """A pause at a simulated time is what was asked for; one by the wall clock cuts the run short."""
    if stop.requested:
        return stop.exit_code
    return Exit.DONE if outcome.state.t >= limits.until else Exit.INTERRUPTED
