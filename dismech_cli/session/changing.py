"""A run that goes on under other settings: a later end, other steps, other frames; never another model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from ..errors import ScenarioError
from ..frozen import frozen
from ..model.saved import save_all, within
from ..output.durable import write_bytes
from ..output.jsonable import Json
from ..output.manifest import Manifest
from ..output.run_directory import SCENARIO_FILE
from ..run.recorder import Checkpoint, Recorder
from ..run.simulation import Simulation
from ..run.step_control import StepControl
from ..scenario.load import LoadedScenario, load
from .inputs import gather_inputs
from .pause import Pause

_MAY_CHANGE = ("numerics.", "output.every", "output.render")
# Which kernels ran is part of what a run is.
_MAY_NOT = ("numerics.kernels",)
_CONTROL = "control."


@frozen
class Change:
    """What a run is to go on with.

    Attributes:
        overrides: ``KEY=VALUE`` texts; none leaves all as it was.
        after: The scenario with them.
        pause: When to pause.
    """

    overrides: tuple[str, ...]
    after: LoadedScenario
    pause: Pause


def asked(before: LoadedScenario, overrides: tuple[str, ...], pause: Pause) -> Change:
    """Tell a later end from a pause on the way, and read the scenario that this asks for.

    Raises:
        ScenarioError: A setting would change the model, or is none.
    """
    for text in overrides:
        key = text.partition("=")[0].strip()
        if not key.startswith(_MAY_CHANGE) or key.startswith(_MAY_NOT):
            raise ScenarioError(
                f"--set {text}: in the middle of a run only numerics, output.every and output.render may "
                "change; for another model start a new run: dismech run"
            )
    after = _reloaded(before, overrides)
    end = after.scenario.numerics.t_end
    if pause.until is not None and end is not None and pause.limits().until > end:
        overrides = (*overrides, f"numerics.t_end={pause.until}")
        pause = replace(pause, until=None)
    end = before.scenario.numerics.t_end
    if overrides and end is not None and after.scenario.output.every is None:
        # frames go on at the interval that followed from the end before
        overrides = (*overrides, f"output.every={end / 100.0!r} s")
    return Change(overrides, _reloaded(before, overrides), pause)


def _reloaded(before: LoadedScenario, overrides: tuple[str, ...]) -> LoadedScenario:
    if not overrides:
        return before
    after = load(before.path, overrides=overrides)
    kinds = {loaded.scenario.numerics.integrator.type for loaded in (before, after)}
    if len(kinds) == 2 and "static" in kinds:
        raise ScenarioError("statics and dynamics are different models: start a new run: dismech run")
    return after


def moved(simulation: Simulation, checkpoint: Checkpoint) -> Checkpoint:
    """A checkpoint from which the changed simulation can go on.

    Raises:
        ScenarioError: The run would end before it.
    """
    fresh, t = simulation.control, checkpoint.t
    if fresh.t_end <= t:
        raise ScenarioError(f"the run stands at t = {t:.6g} s: it cannot end at {fresh.t_end:.6g} s")
    kept = {name: x for name, x in checkpoint.arrays.items() if not name.startswith(_CONTROL)}
    counts = {name: x for name, x in checkpoint.numbers.items() if not name.startswith(_CONTROL)}
    arrays, numbers = save_all({"control": _placed(fresh, checkpoint)})
    return Checkpoint({**kept, **arrays}, {**counts, **numbers})


def _placed(fresh: StepControl, checkpoint: Checkpoint) -> StepControl:
    """A control where the one of a checkpoint stands, which may be of another kind."""
    arrays, numbers = within("control", checkpoint.arrays), within("control", checkpoint.numbers)
    if numbers.keys() != fresh.numbers().keys():
        return fresh.starting(checkpoint.t)
    return fresh.joining(fresh.restore(arrays, numbers), checkpoint.t)


def keep(
    run_dir: Path,
    manifest: Manifest,
    recorded: Mapping[str, Json] | None,
    checkpoint: Checkpoint | None,
    change: Change,
) -> tuple[Manifest, Mapping[str, Json] | None]:
    """Record a change: in the checkpoint, the copy of the scenario, and the manifest, which is not saved.

    Raises:
        OutputError: One cannot be written.
    """
    text = gather_inputs(change.after).text
    identity = None if recorded is None else {**recorded, "scenario": text}
    if checkpoint is not None and identity is not None:
        Recorder(run_dir, (), identity).checkpoint(*checkpoint)
    write_bytes(run_dir / SCENARIO_FILE, text.encode())
    t = 0.0 if checkpoint is None else checkpoint.t
    line = f"from t = {t:.6g} s on: {', '.join(change.overrides)}"
    hashes = {**manifest.hashes, SCENARIO_FILE: change.after.text_hash}
    return replace(manifest, changes=(*manifest.changes, line), hashes=hashes), identity
