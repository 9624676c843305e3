"""A new run of a scenario file: read, compose, make its directory, go, draw."""

from __future__ import annotations

import time
from pathlib import Path

from ..compose.structure.kernels import Repays, alone
from ..control.plugin import load_plugins
from ..frozen import frozen
from ..output import run_directory
from ..run.interrupt import stop_on_signals
from ..scenario.load import LoadedScenario, load
from .composing import composed, tell_doubts
from .conduct import Finished
from .inputs import gather_inputs
from .loops import doubtful_loops, nominal_step
from .narrator import Narrator
from .pause import Pause
from .record import Prepared, record

RESULTS = Path("results")


@frozen(kw_only=True)
class Start:
    """What to run, as given on the command line.

    Attributes:
        path: The scenario file.
        overrides: ``KEY=VALUE`` texts.
        profile: ``draft``, ``normal``, ``accurate`` or None.
        allow_outside: Whether files may lie outside the folder of the scenario.
        output: The run directory; None makes a new one under ``results``.
        overwrite: Whether the run in ``output`` may be replaced.
        draw: Whether the pictures that the scenario asks for are drawn.
        pause: When to pause.
        plugins: Files of controllers.
        repays: What compiling kernels must save, if the plan chooses them.
    """

    path: Path
    overrides: tuple[str, ...]
    profile: str | None
    allow_outside: bool
    output: Path | None
    overwrite: bool
    draw: bool
    pause: Pause
    plugins: tuple[Path, ...] = ()
    repays: Repays = alone


def start(request: Start, narrator: Narrator) -> Finished:
    """Run a scenario; nothing is written before it is read and composed.

    Raises:
        ScenarioError: It cannot be read or composed.
        OutputError: A result cannot be written.
    """
    limits = request.pause.limits()
    tick = time.perf_counter()
    loaded = load(
        request.path,
        overrides=request.overrides,
        profile=request.profile,
        allow_outside=request.allow_outside,
    )
    for warning in loaded.warnings:
        narrator.warn(warning)
    if loaded.scenario.sweep is not None:
        narrator.say(
            "one run, of the values as written: dismech sweep runs the points of its section 'sweep'"
        )
    tock = time.perf_counter()
    plugins = load_plugins(request.plugins)
    composition = composed(loaded, None, narrator, plugins, request.repays)
    tell_doubts(composition, narrator)
    for doubt in doubtful_loops(composition.simulation, nominal_step(loaded.scenario.numerics)):
        narrator.warn(doubt)
    prepared = Prepared(
        loaded=loaded,
        composition=composition,
        inputs=gather_inputs(
            loaded, composition.kept, plugins, composition.followed, composition.plan.kernels
        ),
        limits=limits,
        seconds={"load": tock - tick, "build": time.perf_counter() - tock},
    )
    run_dir = _directory(request, loaded)
    with stop_on_signals() as stop:
        done = record(prepared, run_dir, stop, narrator)
    if not request.draw:
        return Finished(done)
    from .drawing import draw_asked

    return draw_asked(done, loaded, narrator)


def _directory(request: Start, loaded: LoadedScenario) -> Path:
    if request.output is None:
        return run_directory.create(RESULTS, loaded.scenario.name, loaded.text_hash)
    make = run_directory.replace_at if request.overwrite else run_directory.create_at
    return make(request.output)
