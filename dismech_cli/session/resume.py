"""A run that was stopped or killed goes on."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from ..control.plugin import Loaded, load_plugins
from ..errors import OutputError, ScenarioError
from ..kernels.availability import numba_fault
from ..output.jsonable import Json
from ..output.leftovers import remove_leftovers
from ..output.manifest import FILE_NAME, Manifest, installed_versions, load_manifest
from ..output.run_directory import LOG_FILE, SCENARIO_FILE, RunLock
from ..run.interrupt import stop_on_signals
from ..run.recorder import Checkpoint, Stored, discard, load_checkpoint, load_open_checkpoint
from ..scenario.load import LoadedScenario, load
from .changing import asked, keep, moved
from .composing import composed
from .conduct import Finished, Record, Session, conduct
from .ending import Ending
from .exit_codes import Exit
from .inputs import gather_inputs, refuse_other, refuse_other_plugins, stored_inputs
from .log import Logged
from .narrator import Narrator
from .pause import Pause
from .phases import added, lost
from .verdicts import Verdict

# Of all steps up to a checkpoint, in its numbers.
_WALL = "stopwatch.wall"


def proceed(
    run_dir: Path,
    pause: Pause,
    narrator: Narrator,
    overrides: tuple[str, ...] = (),
    *,
    draw: bool = True,
    plugins: tuple[Path, ...] = (),
) -> Finished:
    """Continue the run in ``run_dir``; a finished one is returned as it is, unless it gets a later end.

    Args:
        run_dir: Where the run lies.
        pause: When to pause; a time beyond the end of the run is its new end.
        narrator: Told what happens.
        overrides: ``KEY=VALUE`` texts that hold from here on.
        draw: Whether the pictures that the scenario asks for are drawn.
        plugins: Files of controllers, the same as before.

    Raises:
        ScenarioError: The directory holds no run, its checkpoint is of another scenario, or a change would
            make it another model.
        OutputError: No checkpoint is readable, or a result cannot be written.
    """
    pause.limits()
    tick = time.perf_counter()
    if not (run_dir / FILE_NAME).is_file():
        raise ScenarioError(f"{run_dir} is no run directory: it has no {FILE_NAME}")
    with RunLock(run_dir), stop_on_signals() as stop:
        manifest = load_manifest(run_dir)
        if removed := remove_leftovers(run_dir):
            names = ", ".join(str(file.relative_to(run_dir)) for file in removed)
            narrator.say(f"removed what a killed process left half written: {names}")
        before = _scenario(run_dir)
        change = asked(before, overrides, pause)
        later = change.after
        if manifest.status == "done" and _end(later) <= _end(before):
            if change.overrides:
                raise ScenarioError(f"{run_dir} is finished: only a later end, --until T, changes it")
            narrator.say(f"{run_dir} is finished" + (f"; {manifest.message}" if manifest.message else ""))
            return Finished(Record(run_dir=run_dir, manifest=manifest, ending=_ending(run_dir, manifest)))
        files = load_plugins(plugins)
        refuse_other_plugins(run_dir, manifest.hashes, files)
        logged = Logged(narrator, run_dir / LOG_FILE)
        recorded, checkpoint = _stored(
            run_dir, logged, load_open_checkpoint if change.overrides else load_checkpoint
        )
        kernels = (manifest.kernels or None) if recorded is None else str(recorded["kernels"])
        if kernels == "numba" and (fault := numba_fault()):
            raise ScenarioError(f"{run_dir} was run with numba, which {fault.text}")
        tock = time.perf_counter()
        composition = composed(later, kernels, narrator, files)
        built = time.perf_counter()
        if change.overrides:
            if checkpoint is not None:
                checkpoint = moved(composition.simulation, checkpoint)
            manifest, recorded = keep(run_dir, manifest, recorded, checkpoint, change)
            logged.say(manifest.changes[-1])
        wall = 0.0 if checkpoint is None else checkpoint.numbers[_WALL]
        manifest = replace(
            manifest,
            seconds=added(
                manifest.seconds,
                lost(manifest.seconds, wall),
                {"load": tock - tick, "build": built - tock},
            ),
        )
        manifest = replace(manifest, status="running", ended="", exit_code=None, message="", expectations=())
        manifest.save(run_dir)
        identity = recorded or _fresh_identity(run_dir, later, composition.plan.kernels, files)
        logged.say(f"resuming at t = {0.0 if checkpoint is None else checkpoint.t:.6g} s")
        session = Session(
            loaded=later,
            composition=composition,
            run_dir=run_dir,
            manifest=manifest,
            identity=identity,
            checkpoint=checkpoint,
            limits=change.pause.limits(),
            narrator=logged,
        )
        record = conduct(session, stop)
    if not draw:
        return Finished(record)
    from .drawing import draw_asked

    return draw_asked(record, later, narrator)


def _scenario(run_dir: Path) -> LoadedScenario:
    """The scenario of a run as copied."""
    file = run_dir / SCENARIO_FILE
    if not file.is_file():
        raise OutputError(f"cannot resume {run_dir}: it was stopped before {SCENARIO_FILE} was written")
    return load(file)


def _ending(run_dir: Path, manifest: Manifest) -> Ending:
    """How a finished run ended, from its record.

    Raises:
        OutputError: The record is damaged.
    """
    try:
        verdicts = tuple(map(Verdict.of_json, manifest.expectations))
    except ValueError as error:
        raise OutputError(f"cannot read {run_dir / FILE_NAME}: it is damaged ({error})") from error
    return Ending(manifest.exit_code or Exit.DONE, manifest.message, verdicts)


def _end(loaded: LoadedScenario) -> float:
    """End of a run [s]; that of statics does not move."""
    return loaded.scenario.numerics.t_end or 0.0


def _stored(
    run_dir: Path, narrator: Narrator, load_it: Callable[[Path], Stored | None]
) -> tuple[Mapping[str, Json] | None, Checkpoint | None]:
    """Identity and checkpoint of a run; without one it starts anew."""
    stored = load_it(run_dir)
    if stored is None:
        narrator.warn(f"{run_dir} has no checkpoint yet: starting again")
        discard(run_dir)
        return None, None
    recorded, checkpoint = stored
    names = recorded["inputs"]
    assert isinstance(names, Mapping)
    refuse_other(run_dir, recorded, stored_inputs(run_dir, names))
    _compare_versions(recorded, narrator)
    return recorded, checkpoint


def _compare_versions(recorded: Mapping[str, Json], narrator: Narrator) -> None:
    before, now = recorded["versions"], installed_versions()
    assert isinstance(before, Mapping)
    changed = [
        f"{name} {before.get(name, 'absent')} -> {now.get(name, 'absent')}"
        for name in sorted({*before, *now})
        if before.get(name) != now.get(name)
    ]
    if changed:
        narrator.warn(f"the last digits may differ from an uninterrupted run: {', '.join(changed)}")


def _fresh_identity(run_dir: Path, loaded: LoadedScenario, kernels: str, plugins: Loaded) -> dict[str, Json]:
    names = gather_inputs(loaded, plugins=plugins).files
    return stored_inputs(run_dir, names).identity(kernels, installed_versions())
