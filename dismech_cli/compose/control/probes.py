"""Probes of sensors, controllers and shapes."""

from __future__ import annotations

from collections.abc import Callable

from ...arrays import FloatArray
from ...model.state import State
from ...run.observables.control_probes import OVER, SIZE, AtPlaces, ShapeDistance
from ...run.observables.probes import Probe
from ...scenario.language.probe import ControlProbe, SensorProbe, ShapeProbe, quantity_of
from ...scenario.language.sensor import ProbeSensor
from ...scenario.text.tree import KeyPath
from ...scenario.values.strain import KIND_OF
from ...units import KINDS
from ..scene import Scene
from .control import Control
from .targets import shape_nodes


def control_probe(
    scene: Scene, control: Control, spec: SensorProbe | ControlProbe | ShapeProbe, path: KeyPath
) -> Probe:
    """Put a probe on what it reads.

    Raises:
        ScenarioError: A plugin without a target has no error.
    """
    match spec:
        case SensorProbe(sensor=name):
            return AtPlaces(control.readings[name], OVER[spec.measure], _unit(scene, name))
        case ControlProbe(controller=name):
            springs = control.springs[name]
            unit = KINDS[KIND_OF[springs.what[0]]].unit
            return AtPlaces(_values(scene, control, spec, path), SIZE[spec.over], unit)
        case ShapeProbe(shape=body, target=file):
            return ShapeDistance(
                scene.geometry.body_nodes[body], shape_nodes(scene, body, file, (*path, "target"))
            )


def _unit(scene: Scene, sensor: str) -> str:
    spec = scene.scenario.sensors[sensor]
    kind = quantity_of(spec.probe) if isinstance(spec, ProbeSensor) else KIND_OF[spec.strain]
    return KINDS[kind].unit


def _values(
    scene: Scene, control: Control, spec: ControlProbe, path: KeyPath
) -> Callable[[State], FloatArray]:
    """What a controller does at each of its places."""
    name = spec.controller
    loop, target, reading = control.loops[name], control.targets[name], control.springs[name].reading
    if spec.measure == "command":
        return loop.command
    if spec.measure == "reading":
        return reading
    if not target(0.0).size:
        raise scene.error((*path, "measure"), f"controller '{name}' has no target to be off from")
    return lambda state: target(state.t) - reading(state)
