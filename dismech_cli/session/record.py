"""A new run with a directory: its record, its inputs, its log, and then the steps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..compose.compose import Composition
from ..frozen import frozen
from ..output.manifest import Manifest, installed_versions
from ..output.run_directory import LOG_FILE, RunLock
from ..run.interrupt import StopRequest
from ..run.loop import Limits
from ..run.sink import Sink
from ..scenario.load import LoadedScenario
from ..scenario.views.provenance import as_json
from .conduct import Record, Session, conduct
from .inputs import Inputs
from .log import Logged
from .narrator import Narrator


@frozen(kw_only=True)
class Prepared:
    """A scenario ready to run.

    Attributes:
        loaded: The scenario.
        composition: What was composed from it.
        inputs: Files that it depends on.
        limits: When to pause.
        seconds: Wall time that it took so far, by phase [s].
    """

    loaded: LoadedScenario
    composition: Composition
    inputs: Inputs
    limits: Limits
    seconds: Mapping[str, float]


def record(
    prepared: Prepared, run_dir: Path, stop: StopRequest, narrator: Narrator, sinks: tuple[Sink, ...] = ()
) -> Record:
    """Run a scenario into a new directory.

    Args:
        prepared: What to run.
        run_dir: The directory, made and empty.
        stop: Set by signals.
        narrator: Told what happens; the log is too.
        sinks: Given what the files are given.

    Raises:
        OutputError: A result cannot be written.
    """
    loaded, inputs = prepared.loaded, prepared.inputs
    with RunLock(run_dir):
        versions = installed_versions()
        manifest = Manifest(
            name=loaded.scenario.name,
            run_id=run_dir.name,
            versions=versions,
            hashes=_hashes(loaded, inputs),
            overrides=loaded.overrides,
            parameters=as_json(loaded.parameters),
            plan=str(prepared.composition.plan),
            kernels=prepared.composition.plan.kernels,
            seconds=prepared.seconds,
        )
        manifest.save(run_dir)
        inputs.write(run_dir)
        logged = Logged(narrator, run_dir / LOG_FILE)
        session = Session(
            loaded=loaded,
            composition=prepared.composition,
            run_dir=run_dir,
            manifest=manifest,
            identity=inputs.identity(prepared.composition.plan.kernels, versions),
            checkpoint=None,
            limits=prepared.limits,
            narrator=logged,
            sinks=sinks,
        )
        logged.say(f"results: {run_dir}")
        return conduct(session, stop)


def _hashes(loaded: LoadedScenario, inputs: Inputs) -> dict[str, str]:
    """SHA-256 of the resolved scenario under the name of its file, and of every file it names."""
    originals = {str(inputs.files[name]): digest for name, digest in inputs.hashes.items()}
    return {str(loaded.path): loaded.text_hash, **originals}
