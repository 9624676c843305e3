"""One run, from what was composed to the record of how it ended; the same for a run and its resumption."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ..compose.compose import Composition
from ..errors import DismechError, OutputError
from ..frozen import frozen
from ..output.jsonable import Json, to_json
from ..output.manifest import Manifest, Status, utc_now
from ..run.interrupt import StopRequest
from ..run.loop import Limits, Outcome, run
from ..run.recorder import Checkpoint, Recorder
from ..run.sink import Sink
from ..run.touched import Penetration
from ..scenario.load import LoadedScenario
from .ending import Ending, conclude
from .exit_codes import code_of
from .narrator import Narrator
from .phases import added
from .sinks import Latest, Several, Telling


@frozen(kw_only=True)
class Session:
    """A run about to go on.

    Attributes:
        loaded: The scenario.
        composition: What was composed from it.
        run_dir: Where results go; locked by the caller.
        manifest: As saved, status ``running``.
        identity: What a checkpoint must agree with.
        checkpoint: Where to go on from, or None.
        limits: When to pause.
        narrator: Told what happens.
        sinks: Given what the files are given, after them.
    """

    loaded: LoadedScenario
    composition: Composition
    run_dir: Path
    manifest: Manifest
    identity: Mapping[str, Json]
    checkpoint: Checkpoint | None
    limits: Limits
    narrator: Narrator
    sinks: tuple[Sink, ...] = ()


@frozen(kw_only=True)
class Record:
    """A run as recorded.

    Attributes:
        run_dir: Where it lies.
        manifest: As saved.
        ending: How it ended.
        outcome: What this process stepped; None if it stepped nothing or was stopped at once.
    """

    run_dir: Path
    manifest: Manifest
    ending: Ending
    outcome: Outcome | None = None


@frozen
class Finished:
    """A run after all that was asked for.

    Attributes:
        record: The run as recorded.
        pictures: Files drawn.
    """

    record: Record
    pictures: tuple[Path, ...] = ()


def conduct(session: Session, stop: StopRequest) -> Record:
    """Step to the end, a failure or an interruption, and record it.

    Raises:
        OutputError: A result could not be written; the manifest says so if that was still possible.
    """
    run_dir, narrator = session.run_dir, session.narrator
    recorder = Recorder(run_dir, session.loaded.scenario.output.writers, session.identity)
    latest = Latest()
    tick = time.perf_counter()
    try:
        outcome = _run(session, recorder, latest, stop)
        recorder.close()
    except KeyboardInterrupt:
        _abandon(recorder)
        narrator.error(f"stopped at once; {_advice(run_dir)}")
        ending = Ending(stop.exit_code, "stopped at once")
        manifest = _ended(session, "interrupted", ending, latest)
        return Record(run_dir=run_dir, manifest=manifest, ending=ending)
    except BaseException as error:
        _abandon(recorder)
        with suppress(OutputError):
            message = str(error) if isinstance(error, DismechError) else repr(error)
            _ended(session, "failed", Ending(code_of(error), message), latest)
        raise
    # files were opened before the first step and closed after the last
    around = time.perf_counter() - tick - sum(outcome.seconds.values())
    outcome = replace(outcome, seconds=added(outcome.seconds, {"write": around}))
    ending = conclude(
        session.loaded,
        outcome,
        session.limits,
        stop,
        narrator,
        advice=_advice(run_dir, outcome.remedy),
    )
    manifest = _ended(session, outcome.end.value, ending, latest, outcome)
    return Record(run_dir=run_dir, manifest=manifest, ending=ending, outcome=outcome)


def _run(session: Session, recorder: Recorder, latest: Latest, stop: StopRequest) -> Outcome:
    simulation = session.composition.simulation
    resume_at = None if session.checkpoint is None else session.checkpoint.t
    versions = {f"version.{name}": text for name, text in session.manifest.versions.items()}
    metadata = {"name": simulation.name, "scenario": str(session.identity["scenario"]), **versions}
    recorder.open(simulation.topology, metadata, resume_at)
    return run(
        simulation,
        Several((recorder, latest, *session.sinks, Telling(session.narrator))),
        limits=session.limits,
        stop=stop,
        resume_from=session.checkpoint,
        announce=session.narrator.detail,
    )


def _advice(run_dir: Path, remedy: str = "") -> str:
    """The line to type next."""
    command = f"resume with: dismech resume {run_dir}"
    return f"{command} --set '{remedy}'" if remedy else command


def _abandon(recorder: Recorder) -> None:
    """Close the files after a failure that is told already."""
    with suppress(OutputError):
        recorder.close()


def _ended(
    session: Session, status: Status, ending: Ending, latest: Latest, outcome: Outcome | None = None
) -> Manifest:
    """Save the manifest with the end of the run."""
    before = session.manifest
    seconds = added(before.seconds, outcome.seconds if outcome is not None else {})
    manifest = replace(
        before,
        status=status,
        ended=utc_now(),
        exit_code=int(ending.code),
        message=ending.message,
        counters=before.counters if outcome is None else outcome.counters,
        seconds=seconds,
        expectations=tuple(verdict.as_json() for verdict in ending.verdicts),
    )
    if outcome is not None and outcome.penetration is not None:
        manifest = replace(manifest, penetration=_told(session, outcome.penetration))
    if latest.scalars:
        probes = {name: to_json(latest.scalars[name]) for name in session.composition.simulation.probes}
        manifest = replace(manifest, probes=probes, energy_error=to_json(latest.scalars.get("error")))
    manifest.save(session.run_dir)
    return manifest


def _told(session: Session, found: Penetration) -> dict[str, Json]:
    """The deepest penetration in words and numbers."""
    return {
        "share": found.share,
        "between": list(found.pair),
        "near": session.composition.simulation.places[found.node],
        "t": found.t,
    }
