"""A new run: read, build, make its directory, go."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

from ..cli.options import Pause
from ..cli.pictures import make_pictures, wanted
from ..cli.presenting import Presenting
from ..compose.compose import compose
from ..errors import ScenarioError
from ..output import run_directory
from ..output.manifest import Manifest, installed_versions
from ..output.run_directory import LOG_FILE, RunLock
from ..quantities import QuantityError, parse_quantity
from ..run.interrupt import stop_on_signals
from ..run.loop import Limits
from ..scenario.load import LoadedScenario, load
from ..units import KINDS
from .conduct import Report, Session, conduct
from .inputs import Inputs, gather_inputs

RESULTS = Path("results")


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """What to run, as given on the command line.

    Attributes:
        path: The scenario file.
        overrides: ``KEY=VALUE`` texts.
        profile: ``draft``, ``normal``, ``accurate`` or None.
        allow_outside: Whether files may lie outside the folder of the scenario.
        output: The run directory; None makes a new one under ``results``.
        overwrite: Whether the run in ``output`` may be replaced.
        pause: When to pause.
    """

    path: Path
    overrides: tuple[str, ...]
    profile: str | None
    allow_outside: bool
    output: Path | None
    overwrite: bool
    pause: Pause


def start(request: Start, present: Presenting) -> int:
    """Run a scenario; nothing is written before it is read and built.

    Returns:
        The exit code.

    Raises:
        ScenarioError: It cannot be read or built.
        OutputError: A result cannot be written.
    """
    limits = make_limits(request.pause)
    tick = time.perf_counter()
    loaded = load(
        request.path,
        overrides=request.overrides,
        profile=request.profile,
        allow_outside=request.allow_outside,
    )
    for warning in loaded.warnings:
        present.console.warn(warning)
    tock = time.perf_counter()
    built = compose(loaded, planned=present.planned)
    for note in built.geometry.notes:
        present.console.say(note)
    for warning in built.plan.warnings:
        present.console.warn(warning)
    inputs = gather_inputs(loaded)
    seconds = {"load": tock - tick, "build": time.perf_counter() - tock}
    run_dir = _directory(request, loaded)
    with RunLock(run_dir), stop_on_signals() as stop:
        versions = installed_versions()
        manifest = Manifest(
            name=loaded.scenario.name,
            run_id=run_dir.name,
            versions=versions,
            hashes=_hashes(loaded, inputs),
            plan=str(built.plan),
            seconds=seconds,
        )
        manifest.save(run_dir)
        inputs.write(run_dir)
        console = replace(present.console, log=run_dir / LOG_FILE)
        session = Session(
            loaded=loaded,
            built=built,
            run_dir=run_dir,
            manifest=manifest,
            identity=inputs.identity(built.plan.kernels, versions),
            checkpoint=None,
            limits=limits,
            reporter=present.reporter(),
            console=console,
        )
        console.say(f"results: {run_dir}")
        report = conduct(session, stop)
    return finish(loaded, run_dir, report, present)


def finish(loaded: LoadedScenario, run_dir: Path, report: Report, present: Presenting) -> int:
    """Draw what the scenario asks for, show the result, return the exit code."""
    pictures: list[str] = []
    render = loaded.scenario.output.render
    if report.manifest.status == "done" and wanted(render):
        console = replace(present.console, log=run_dir / LOG_FILE)
        pictures = make_pictures(run_dir, render, report.manifest.counters["frames"], console)
    present.result(run_dir, report, pictures)
    return int(report.manifest.exit_code or 0)


def make_limits(pause: Pause) -> Limits:
    """When to pause.

    Raises:
        ScenarioError: The time is no time.
    """
    limits = Limits(checkpoint_every=pause.checkpoint_every)
    if pause.wall is not None:
        limits = replace(limits, wall=pause.wall)
    if pause.until is not None:
        try:
            until = parse_quantity(pause.until, KINDS["time"])
        except QuantityError as error:
            raise ScenarioError(f"--until {pause.until!r}: {error}") from None
        if until <= 0.0:
            raise ScenarioError(f"--until {pause.until!r}: expected a time above zero")
        # The sum of many steps may fall short of the time by rounding.
        limits = replace(limits, until=until * (1.0 - 1e-12))
    return limits


def _directory(request: Start, loaded: LoadedScenario) -> Path:
    if request.output is None:
        return run_directory.create(RESULTS, loaded.scenario.name, loaded.text_hash)
    make = run_directory.replace_at if request.overwrite else run_directory.create_at
    return make(request.output)


def _hashes(loaded: LoadedScenario, inputs: Inputs) -> dict[str, str]:
    """SHA-256 of the resolved scenario under the name of its file, and of every file it names."""
    originals = {str(inputs.files[name]): digest for name, digest in inputs.hashes.items()}
    return {str(loaded.path): loaded.text_hash, **originals}
