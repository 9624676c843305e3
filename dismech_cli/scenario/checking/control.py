"""Contradictions of controllers and sensors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from ...words import hint
from ..language.actuation import Controlled
from ..language.control import Controller, Ideal, Incremental, Plugin, Positional
from ..language.numerics import Static
from ..language.probe import (
    ContactProbe,
    ControlProbe,
    EnergyProbe,
    LoadFactorProbe,
    ReactionProbe,
    SensorProbe,
    ShapeProbe,
    StabilityProbe,
)
from ..language.scenario import Scenario
from ..language.sensor import (
    CurvatureSensor,
    DihedralSensor,
    ProbeSensor,
    RodSensor,
    StretchSensor,
    SurfaceCurvatureSensor,
    TwistSensor,
)
from ..text.tree import KeyPath
from ..views.walk import probes
from .finding import Finding

_UNREAD = (
    EnergyProbe
    | ReactionProbe
    | ContactProbe
    | LoadFactorProbe
    | StabilityProbe
    | SensorProbe
    | ControlProbe
    | ShapeProbe
)

MAX_SAMPLES: Final = 1_000_000
"""Samples of a controller in a run: a step ends at each."""


def control_findings(scenario: Scenario) -> Iterator[Finding]:
    """What cannot be meant."""
    yield from _driven(scenario)
    yield from _sensors(scenario)
    yield from _probes(scenario)
    dt = None if scenario.numerics.adapts else scenario.numerics.dt
    end = scenario.numerics.t_end or 0.0
    for name, spec in scenario.controllers.items():
        path = ("controllers", name)
        samples = 0.0 if isinstance(spec, Ideal) else (end - spec.start) / spec.period
        if samples > MAX_SAMPLES:
            yield (
                (*path, "period"),
                f"{samples:.3g} samples to the end of the run at {end:g} s; at most {MAX_SAMPLES:.0e}",
            )
        for key, sensor in _read(spec, path):
            if sensor not in scenario.sensors:
                yield key, f"no sensor is named {sensor!r}{hint(sensor, scenario.sensors)}"
        match spec:
            case Positional() | Incremental() if spec.sensor in scenario.sensors:
                assert spec.sensor is not None
                if isinstance(scenario.sensors[spec.sensor], ProbeSensor):
                    yield (
                        (*path, "sensor"),
                        f"{spec.sensor!r} reads a probe, not the strain that this commands",
                    )
            case _:
                pass
        if isinstance(spec, Ideal) and dt is not None and spec.gains.i * dt >= 2.0 * (1.0 + spec.gains.p):
            most = 2.0 * (1.0 + spec.gains.p) / dt
            yield (
                (*path, "gains", "i"),
                f"cannot be stable at this dt of {dt:g} s: take less than 2 (1 + p) / dt = {most:g} 1/s",
            )


def control_doubts(scenario: Scenario) -> Iterator[Finding]:
    """What is allowed but looks like a slip."""
    dt = None if scenario.numerics.adapts else scenario.numerics.dt
    for name, spec in scenario.controllers.items():
        if not isinstance(spec, Ideal) and dt is not None and spec.period < dt * (1.0 - 1e-9):
            message = f"shorter than dt: steps end at samples, every {spec.period:g} s and not {dt:g} s"
            yield ("controllers", name, "period"), message


def _driven(scenario: Scenario) -> Iterator[Finding]:
    """Every controller drives one thing."""
    static = isinstance(scenario.numerics.integrator, Static)
    first: dict[str, int] = {}
    for i, part in enumerate(scenario.actuation):
        if not isinstance(part.value, Controlled):
            continue
        path, name = ("actuation", i, "value", "controlled_by"), part.value.controlled_by
        if name not in scenario.controllers:
            yield path, f"no controller is named {name!r}{hint(name, scenario.controllers)}"
        elif name in first:
            yield path, f"{name!r} drives actuation[{first[name]}] already: each controller drives one thing"
        elif scenario.controllers[name].strain != part.type:
            yield path, f"{name!r} commands {scenario.controllers[name].strain}, not {part.type}"
        first.setdefault(name, i)
    for name in scenario.controllers:
        if name not in first:
            yield ("controllers", name), "drives nothing: no actuation says 'controlled_by' it"
        if static:
            yield ("controllers", name), "a static run has no time to control in: take a run in time"


def _sensors(scenario: Scenario) -> Iterator[Finding]:
    rods = [rod.name for rod in scenario.rods.values()]
    shells = [shell.name for shell in scenario.shells.values()]
    for name, spec in scenario.sensors.items():
        path = ("sensors", name)
        match spec:
            case ProbeSensor(probe=probe) if isinstance(probe, _UNREAD):
                yield (
                    (*path, "probe"),
                    "a sensor reads where things are and how they move: displacement, position, velocity, "
                    "distance, mean_position, twist or turn",
                )
            case StretchSensor() | CurvatureSensor() | TwistSensor() if spec.rod not in rods:
                yield (*path, "rod"), f"no rod is named {spec.rod!r}{hint(spec.rod, rods)}"
            case DihedralSensor() | SurfaceCurvatureSensor() if spec.shell not in shells:
                yield (*path, "shell"), f"no shell is named {spec.shell!r}{hint(spec.shell, shells)}"
            case _:
                pass
        if isinstance(spec, TwistSensor) and scenario.dimension == 2:
            yield (*path, "strain"), "a planar scene has no twist"
        if isinstance(spec, RodSensor) and spec.joints is not None and spec.joints[1] < spec.joints[0]:
            yield (*path, "joints"), f"a range goes from first to last, got {list(spec.joints)}"


def _probes(scenario: Scenario) -> Iterator[Finding]:
    bodies = [body.name for body in scenario.geometry]
    for path, probe in probes(scenario):
        match probe:
            case SensorProbe(sensor=name) if name not in scenario.sensors:
                yield (*path, "sensor"), f"no sensor is named {name!r}{hint(name, scenario.sensors)}"
            case ControlProbe(controller=name) if name not in scenario.controllers:
                near = hint(name, scenario.controllers)
                yield (*path, "controller"), f"no controller is named {name!r}{near}"
            case ShapeProbe(shape=name) if name not in bodies:
                yield (*path, "shape"), f"no body is named {name!r}{hint(name, bodies)}"
            case _:
                pass


def _read(spec: Controller, path: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    """Sensors that a controller names, with their places."""
    match spec:
        case Plugin(sensors=names):
            for k, name in enumerate(names):
                yield (*path, "sensors", k), name
        case Positional(sensor=str() as name) | Incremental(sensor=str() as name):
            yield (*path, "sensor"), name
        case _:
            pass
