"""How steps go: through the stages of an integrator, or along a path of equilibria to its end."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..model.model import Model
from ..model.state import State
from ..run.observables.probes import LoadFactor, Probe
from ..run.observables.snapshot import Snapshot
from ..scenario.language.load_path import LoadPath
from ..scenario.language.numerics import Static
from ..solve.path import Goal, PathFollower
from ..solve.path_metric import PathMetric
from ..solve.relax import relaxed
from ..solve.step import Advance, through_stages
from .control.control import Control
from .observables.probes import make_probe
from .scene import Scene
from .structure.structure import Structure

WAYS: dict[str, Advance] = {"newton": through_stages, "relax": relaxed}
"""How statics find equilibria."""


def make_advance(scene: Scene, structure: Structure, control: Control, model: Model) -> Advance:
    """How the steps of a run go."""
    integrator = scene.scenario.numerics.integrator
    if isinstance(integrator, Static) and integrator.path is not None:
        spec = integrator.path
        goal = _goal(spec, scene, structure, control, model)
        return PathFollower(PathMetric.of(model, spec.load_factor), spec.load_factor, (goal,))
    return WAYS[integrator.method] if isinstance(integrator, Static) else through_stages


def _goal(spec: LoadPath, scene: Scene, structure: Structure, control: Control, model: Model) -> Goal:
    if spec.until is None:
        return Goal(_of_shape(LoadFactor(), model), spec.load_factor)
    path = ("numerics", "integrator", "path", "until", "probe")
    return Goal(
        _of_shape(make_probe(scene, structure, control, spec.until.probe, path), model), spec.until.value
    )


def _of_shape(probe: Probe, model: Model) -> Callable[[State], float]:
    """A probe that reads nothing but the shape and the load factor."""
    nothing: Mapping[str, float] = {}

    def read(state: State) -> float:
        at_rest = np.zeros_like(state.q)
        return probe(
            Snapshot(
                model,
                state,
                at_rest,
                lambda: nothing,
                lambda: 0.0,
                lambda _: at_rest,
                lambda _: at_rest,
                tuple,
            )
        )

    return read
