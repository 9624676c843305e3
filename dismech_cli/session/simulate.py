"""A scenario run from Python."""

from __future__ import annotations

import signal
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..control.plugin import load_plugins
from ..errors import ScenarioError
from ..output import run_directory
from ..run.interrupt import StopRequest, stop_on_signals
from ..run.loop import Limits, Outcome, run
from ..scenario.load import LoadedScenario, load, load_mapping
from .composing import composed, tell_doubts
from .ending import Ending, conclude
from .exit_codes import Exit
from .inputs import gather_inputs
from .loops import doubtful_loops, nominal_step
from .narrator import Narrator, Silent
from .phases import added
from .record import Prepared, record
from .report import Report, Series, columns
from .sinks import Memory, Several, Telling
from .thread_limits import ThreadLimits


def simulate(
    scenario: str | Path | Mapping[str, Any] | LoadedScenario,
    *,
    overrides: Sequence[str] = (),
    profile: str | None = None,
    limits: Limits = Limits(),
    kernels: str | None = None,
    out: str | Path | None = None,
    plugins: Sequence[str | Path] = (),
    narrator: Narrator = Silent(),
) -> Report:
    """Run a scenario to its end, or to a limit.

    A run that fails is a report too; :meth:`.Report.raise_for_status` makes an error of it. While it
    lasts, NumPy, SciPy and MKL have the threads that the environment says (``OMP_NUM_THREADS``, ...),
    else one each, as on the command line.

    Args:
        scenario: A file, by its path; a mapping, see :func:`.load_mapping`; or what :func:`.load` and
            :func:`.load_text` return. A ``str`` is always a path, never the text of a scenario.
        overrides: Arguments such as ``numerics.dt=5 ms``, applied in order.
        profile: ``draft``, ``normal`` or ``accurate``.
        limits: When to pause.
        kernels: ``numpy`` or ``numba``, in place of the plan's choice.
        out: A new or empty folder that becomes the run directory, as with ``dismech run -o``, without
            pictures. Ctrl-C then finishes the step and leaves a run that ``dismech resume`` continues.
        plugins: Files of controllers, as ``--plugin`` names them; they run as programs.
        narrator: Told what happens.

    Raises:
        ScenarioError: The scenario cannot be read or composed, or was loaded before and is to be changed.
        OutputError: A result cannot be written to ``out``.
    """
    tick = time.perf_counter()
    loaded = _loaded(scenario, overrides, profile)
    for warning in loaded.warnings:
        narrator.warn(warning)
    tock = time.perf_counter()
    with ThreadLimits() as threads:
        files = load_plugins([Path(one) for one in plugins])
        composition = composed(loaded, kernels, narrator, files)
        tell_doubts(composition, narrator)
        doubts = doubtful_loops(composition.simulation, nominal_step(loaded.scenario.numerics))
        for doubt in doubts:
            narrator.warn(doubt)
        prepared = Prepared(
            loaded=loaded,
            composition=composition,
            inputs=gather_inputs(
                loaded, composition.kept, files, composition.followed, composition.plan.kernels
            ),
            limits=limits,
            seconds={"load": tock - tick, "build": time.perf_counter() - tock},
        )
        memory = Memory()
        sinks = (threads, memory)
        if out is None:
            outcome, ending = _in_memory(prepared, narrator, sinks)
        else:
            outcome, ending = _in_directory(prepared, Path(out), narrator, sinks)
    scalars = columns(memory.frames, tuple(composition.simulation.topology.scalars))
    return Report(
        exit=Exit(ending.code),
        message=ending.message,
        verdicts=ending.verdicts,
        frames=tuple(memory.frames),
        scalars=scalars,
        probes={name: scalars[name] for name in composition.simulation.probes},
        watched={name: Series(outcome.times, values) for name, values in outcome.watched.items()},
        warnings=(*loaded.warnings, *composition.plan.warnings, *doubts, *outcome.doubts),
        seconds=added(prepared.seconds, outcome.seconds),
        run_dir=None if out is None else Path(out),
        outcome=outcome,
        composition=composition,
    )


def _loaded(
    scenario: str | Path | Mapping[str, Any] | LoadedScenario, overrides: Sequence[str], profile: str | None
) -> LoadedScenario:
    match scenario:
        case str() | Path():
            return load(scenario, overrides=overrides, profile=profile)
        case LoadedScenario():
            if overrides or profile is not None:
                raise ScenarioError(
                    "overrides and profile change a scenario while it is loaded: give them there"
                )
            return scenario
        case _:
            return load_mapping(scenario, overrides=overrides, profile=profile)


def _in_memory(
    prepared: Prepared, narrator: Narrator, sinks: tuple[ThreadLimits, Memory]
) -> tuple[Outcome, Ending]:
    outcome = run(
        prepared.composition.simulation,
        Several((*sinks, Telling(narrator))),
        limits=prepared.limits,
        announce=narrator.detail,
    )
    return outcome, conclude(prepared.loaded, outcome, prepared.limits, StopRequest(), narrator, advice="")


def _in_directory(
    prepared: Prepared, out: Path, narrator: Narrator, sinks: tuple[ThreadLimits, Memory]
) -> tuple[Outcome, Ending]:
    """Run into a directory; a signal that came is delivered once the run is recorded.

    Raises:
        KeyboardInterrupt: After a signal that the process survived.
    """
    run_dir = run_directory.create_at(out)
    with stop_on_signals() as stop:
        done = record(prepared, run_dir, stop, narrator, sinks)
    if stop.signal is not None:
        signal.raise_signal(stop.signal)
    if stop.signal is not None or done.outcome is None:
        raise KeyboardInterrupt
    return done.outcome, done.ending
