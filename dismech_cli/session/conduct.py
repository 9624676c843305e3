"""One run, from what was built to the record of how it ended; the same for a run and its resumption."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from ..cli.console import Console
from ..cli.exits import Exit, code_of
from ..compose.compose import Composition
from ..errors import DismechError, OutputError
from ..output.jsonable import Json
from ..output.manifest import Manifest, Status, utc_now
from ..run.interrupt import StopRequest
from ..run.loop import End, Limits, Outcome, run
from ..run.progress import Reporter
from ..run.recorder import Checkpoint, Recorder
from ..scenario.load import LoadedScenario
from .verdicts import Verdict, judge


@dataclass(frozen=True, slots=True, kw_only=True)
class Session:
    """A run about to go on.

    Attributes:
        loaded: The scenario.
        built: What was built from it.
        run_dir: Where results go; locked by the caller.
        manifest: As saved, status ``running``.
        identity: What a checkpoint must agree with.
        checkpoint: Where to go on from, or None.
        limits: When to pause.
        reporter: Shows progress.
        console: Shows everything else.
    """

    loaded: LoadedScenario
    built: Composition
    run_dir: Path
    manifest: Manifest
    identity: Mapping[str, Json]
    checkpoint: Checkpoint | None
    limits: Limits
    reporter: Reporter
    console: Console


@dataclass(frozen=True, slots=True)
class Report:
    """How a session ended.

    Attributes:
        manifest: As saved.
        verdicts: One per expectation, if the run came to its end.
    """

    manifest: Manifest
    verdicts: tuple[Verdict, ...]


def conduct(session: Session, stop: StopRequest) -> Report:
    """Step to the end, a failure or an interruption, and record it.

    Raises:
        OutputError: A result could not be written; the manifest says so if that was still possible.
    """
    recorder = Recorder(
        session.run_dir,
        session.loaded.scenario.output.writers,
        session.identity,
        session.reporter,
        session.console.detail,
    )
    try:
        outcome = _run(session, recorder, stop)
        recorder.close()
    except KeyboardInterrupt:
        _abandon(recorder)
        session.console.error(f"stopped at once; resume with: dismech resume {session.run_dir}")
        return Report(_ended(session, "interrupted", stop.exit_code, "stopped at once"), ())
    except BaseException as error:
        _abandon(recorder)
        with suppress(OutputError):
            message = str(error) if isinstance(error, DismechError) else repr(error)
            _ended(session, "failed", code_of(error), message)
        raise
    return _conclude(session, outcome, stop)


def _run(session: Session, recorder: Recorder, stop: StopRequest) -> Outcome:
    simulation = session.built.simulation
    resume_at = None if session.checkpoint is None else session.checkpoint.t
    versions = {f"version.{name}": text for name, text in session.manifest.versions.items()}
    metadata = {"name": simulation.name, "scenario": str(session.identity["scenario"]), **versions}
    recorder.open(simulation.topology, metadata, resume_at)
    return run(
        simulation,
        recorder,
        limits=session.limits,
        stop=stop,
        resume_from=session.checkpoint,
        announce=session.console.detail,
    )


def _abandon(recorder: Recorder) -> None:
    """Close the files after a failure that is told already."""
    with suppress(OutputError):
        recorder.close()


def _conclude(session: Session, outcome: Outcome, stop: StopRequest) -> Report:
    console, t = session.console, outcome.state.t
    resume = f"resume with: dismech resume {session.run_dir}"
    verdicts: tuple[Verdict, ...] = ()
    code: int
    match outcome.end:
        case End.FAILED:
            console.error(f"{outcome.message}\n  {resume}")
            code, message = Exit.SOLVER, outcome.message
        case End.INTERRUPTED:
            message = f"{outcome.message} at t = {t:.6g} s"
            console.say(f"{message}; {resume}")
            code = _pause_code(session.limits, outcome, stop)
        case End.DONE:
            for doubt in outcome.doubts:
                console.warn(doubt)
            verdicts = judge(session.loaded.scenario.expect, outcome)
            missed = [v.name for v in verdicts if not v.passed]
            code = Exit.EXPECTATION if missed else Exit.DONE
            message = f"missed: {', '.join(missed)}" if missed else ""
            if missed:
                console.error(f"expectation {message}")
    return Report(_ended(session, outcome.end.value, code, message, outcome), verdicts)


def _pause_code(limits: Limits, outcome: Outcome, stop: StopRequest) -> int:
    """A pause at a simulated time is what was asked for; one by the wall clock cuts the run short."""
    if stop.requested:
        return stop.exit_code
    return Exit.DONE if outcome.state.t >= limits.until else Exit.INTERRUPTED


def _ended(
    session: Session, status: str, code: int, message: str, outcome: Outcome | None = None
) -> Manifest:
    """Save the manifest with the end of the run."""
    before = session.manifest
    seconds = dict(before.seconds)
    if outcome is not None:
        seconds |= {name: before.seconds.get(name, 0.0) + s for name, s in outcome.seconds.items()}
        seconds["total"] = outcome.seconds["total"]
    manifest = replace(
        before,
        status=cast(Status, status),
        ended=utc_now(),
        exit_code=int(code),
        message=message,
        counters=before.counters if outcome is None else outcome.counters,
        seconds=seconds,
    )
    manifest.save(session.run_dir)
    return manifest
