"""A run that was stopped or killed goes on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from ..errors import OutputError, ScenarioError
from ..output.jsonable import Json
from ..output.manifest import FILE_NAME, installed_versions, load_manifest
from ..output.run_directory import LOG_FILE, SCENARIO_FILE, RunLock
from ..run.interrupt import stop_on_signals
from ..run.recorder import Checkpoint, discard, load_checkpoint
from ..scenario.load import LoadedScenario, load
from .composing import composed
from .conduct import Record, Session, conduct
from .drawing import Finished, draw_asked
from .ending import Ending
from .exit_codes import Exit
from .inputs import gather_inputs, refuse_other, stored_inputs
from .log import Logged
from .narrator import Narrator
from .pause import Pause


def proceed(run_dir: Path, pause: Pause, narrator: Narrator) -> Finished:
    """Continue the run in ``run_dir``; a finished one is returned as it is.

    Raises:
        ScenarioError: The directory holds no run, or its checkpoint is of another scenario.
        OutputError: No checkpoint is readable, or a result cannot be written.
    """
    limits = pause.limits()
    if not (run_dir / FILE_NAME).is_file():
        raise ScenarioError(f"{run_dir} is no run directory: it has no {FILE_NAME}")
    with RunLock(run_dir), stop_on_signals() as stop:
        manifest = load_manifest(run_dir)
        if manifest.status == "done":
            narrator.say(f"{run_dir} is finished" + (f"; {manifest.message}" if manifest.message else ""))
            ending = Ending(manifest.exit_code or Exit.DONE, manifest.message)
            return Finished(Record(run_dir=run_dir, manifest=manifest, ending=ending))
        logged = Logged(narrator, run_dir / LOG_FILE)
        loaded, recorded, checkpoint = _stored(run_dir, logged)
        kernels = None if recorded is None else str(recorded["kernels"])
        if kernels == "numba" and find_spec("numba") is None:
            raise ScenarioError(
                f"{run_dir} was run with numba, which is missing: pip install 'dismech[fast]'"
            )
        composition = composed(loaded, kernels, narrator)
        manifest = replace(manifest, status="running", ended="", exit_code=None, message="")
        manifest.save(run_dir)
        identity = recorded or _fresh_identity(run_dir, loaded, composition.plan.kernels)
        logged.say(f"resuming at t = {0.0 if checkpoint is None else checkpoint.t:.6g} s")
        session = Session(
            loaded=loaded,
            composition=composition,
            run_dir=run_dir,
            manifest=manifest,
            identity=identity,
            checkpoint=checkpoint,
            limits=limits,
            narrator=logged,
        )
        record = conduct(session, stop)
    return draw_asked(record, loaded.scenario.output.render, narrator)


def _stored(
    run_dir: Path, narrator: Narrator
) -> tuple[LoadedScenario, Mapping[str, Json] | None, Checkpoint | None]:
    """Scenario, identity and checkpoint of a run; without a checkpoint it starts anew."""
    file = run_dir / SCENARIO_FILE
    if not file.is_file():
        raise OutputError(f"cannot resume {run_dir}: it was stopped before {SCENARIO_FILE} was written")
    stored = load_checkpoint(run_dir)
    if stored is None:
        narrator.warn(f"{run_dir} has no checkpoint yet: starting again")
        discard(run_dir)
        return load(file), None, None
    recorded, checkpoint = stored
    names = recorded["inputs"]
    assert isinstance(names, Mapping)
    refuse_other(run_dir, recorded, stored_inputs(run_dir, names))
    _compare_versions(recorded, narrator)
    return load(file), recorded, checkpoint


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


def _fresh_identity(run_dir: Path, loaded: LoadedScenario, kernels: str) -> dict[str, Json]:
    names = gather_inputs(loaded).files
    return stored_inputs(run_dir, names).identity(kernels, installed_versions())
