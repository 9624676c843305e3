"""Loops of the scenario: what they drive, read and reach."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import TypeAlias

import numpy as np

from ...control.channel import Channel
from ...control.checked import Checked
from ...control.controller import Controller
from ...control.incremental import Incremental
from ...control.limits import Limits
from ...control.loop import Controls, IdealLoop, Loop, SampledLoop
from ...control.noise import Noise
from ...control.plugin import Plugins
from ...control.port import IdealPort, Port, SampledPort
from ...control.positional import Positional
from ...control.sensor import Reading, Sensor
from ...control.smoothing import smoothing
from ...control.target import Target, Untold
from ...errors import ScenarioError
from ...frozen import frozen
from ...model.model import Model
from ...run.observables.reading import ProbeReading
from ...scenario.language import control
from ...scenario.language.actuation import Controlled
from ...scenario.language.sensor import ProbeSensor
from ...scenario.text.tree import KeyPath
from ..elastic.elastic import Passive
from ..scene import Scene
from ..structure.structure import Structure
from .control import Control, MakeProbe
from .springs import Springs, find_springs
from .targets import kept_of, make_target

# A delay is a number of periods to within this share of one.
_ROUNDING = 1e-6


@frozen
class Driven:
    """What a controller drives.

    Attributes:
        index: Number of the actuation.
        springs: Its places.
    """

    index: int
    springs: Springs


def make_loops(
    scene: Scene,
    structure: Structure,
    passive: Passive,
    plugins: Plugins,
    make_probe: MakeProbe,
) -> Control:
    """Make all loops; see :func:`.control.make_control`."""
    scenario = scene.scenario
    maker = _Maker(scene, structure, passive, plugins, make_probe)
    readings = {name: maker.reading(name) for name in scenario.sensors}
    loops: dict[str, Loop] = {}
    ports: dict[int, Port] = {}
    first = 0
    for name in scenario.controllers:
        loops[name], port, first = maker.loop(name, readings, first)
        ports[maker.driven[name].index] = port
    return Control(
        controls=Controls(tuple(loops.values())),
        ports=ports,
        size=first,
        events=_events(scene),
        springs={name: driven.springs for name, driven in maker.driven.items()},
        targets=maker.targets,
        loops=loops,
        readings={name: reading for name, (reading, _) in readings.items()},
        kept=kept_of(scene, structure),
    )


def _events(scene: Scene) -> tuple[float, ...]:
    """Times of all samples [s]."""
    end = scene.scenario.numerics.t_end or 0.0
    times = np.empty(0)
    for spec in scene.scenario.controllers.values():
        if isinstance(spec, control.Ideal):
            continue
        count = int((end - spec.start) / spec.period) + 2 if end > spec.start else 0
        times = np.union1d(times, spec.start + spec.period * np.arange(count))
    return tuple(times[times < end].tolist())


_Read: TypeAlias = tuple[Reading, Springs | None]


class _Maker:
    """Makes the loops of one scene."""

    def __init__(
        self,
        scene: Scene,
        structure: Structure,
        passive: Passive,
        plugins: Plugins,
        make_probe: MakeProbe,
    ) -> None:
        self._scene = scene
        self._structure = structure
        self._passive = passive
        self._plugins = plugins
        self._make_probe = make_probe
        self.driven = {
            part.value.controlled_by: Driven(
                index, find_springs(scene, structure, passive, part, ("actuation", index))
            )
            for index, part in enumerate(scene.scenario.actuation)
            if isinstance(part.value, Controlled)
        }
        self._refuse_shared()
        self.targets: dict[str, Target] = {}

    def _refuse_shared(self) -> None:
        """Refuse two controllers of one place, each of which would take the other for a disturbance.

        Raises:
            ScenarioError: naming both.
        """
        before: list[tuple[str, Driven]] = []
        for name, one in self.driven.items():
            for other, two in before:
                if one.springs.shares(two.springs):
                    raise self._scene.error(
                        ("actuation", one.index, "value"),
                        f"'{name}' and '{other}' command the same strain at the same places",
                    )
            before.append((name, one))

    def reading(self, name: str) -> _Read:
        """What a sensor reads, and where if that is a strain."""
        spec, path = self._scene.scenario.sensors[name], ("sensors", name)
        if isinstance(spec, ProbeSensor):
            probe = self._make_probe(spec.probe, (*path, "probe"))
            return ProbeReading(probe, _bare(self._structure)), None
        springs = find_springs(self._scene, self._structure, self._passive, spec, path)
        return springs.reading, springs

    def loop(self, name: str, readings: Mapping[str, _Read], first: int) -> tuple[Loop, Port, int]:
        """The loop of a controller, what drives its springs, and the first input after its own."""
        spec, path = self._scene.scenario.controllers[name], ("controllers", name)
        springs = self.driven[name].springs
        target: Target = Untold()
        if spec.target is not None:
            target = make_target(self._scene, self._structure, springs, spec.target, (*path, "target"))
        self.targets[name] = target
        if isinstance(spec, control.Ideal):
            return _ideal(name, spec, springs, target, first)
        channel = Channel(first, springs.n)
        loop = SampledLoop(
            name=name,
            controller=self._controller(name, spec, springs),
            sensors=self._sensors(name, spec, springs, readings),
            target=target,
            channel=channel,
            period=spec.period,
            first=spec.start,
            held=spec.hold == "step",
        )
        return loop, SampledPort(channel), channel.end

    def _controller(self, name: str, spec: control.Sampled, springs: Springs) -> Controller:
        limits = _limits(spec)
        match spec:
            case control.Positional(gains=gains):
                return Positional(
                    p=gains.p,
                    i=gains.i,
                    d=gains.d,
                    weight=gains.setpoint_weight,
                    forward=spec.feed_forward,
                    period=spec.period,
                    smoothing=smoothing(springs.n, springs.links, springs.spans, spec.smoothing),
                    limits=limits,
                )
            case control.Incremental(gains=slow):
                return Incremental(
                    p=slow.p,
                    i=slow.i,
                    leak=spec.leak,
                    links=springs.links,
                    period=spec.period,
                    limits=limits,
                )
            case control.Plugin():
                return self._plugged(name, spec, springs.n, limits)

    def _plugged(self, name: str, spec: control.Plugin, n: int, limits: Limits) -> Controller:
        try:
            made = self._plugins.make(spec.name, spec.settings)
        except ScenarioError as error:
            raise self._scene.error(("controllers", name, "name"), str(error)) from error
        return Checked(name, made, n, limits)

    def _sensors(
        self, name: str, spec: control.Sampled, springs: Springs, readings: Mapping[str, _Read]
    ) -> tuple[Sensor, ...]:
        if isinstance(spec, control.Plugin):
            return tuple(
                self._sensor(one, spec.period, readings[one][0], ("controllers", name, "sensors", k))
                for k, one in enumerate(spec.sensors)
            )
        if spec.sensor is None:
            return (Sensor(f"of {name}", springs.reading),)
        reading, places = readings[spec.sensor]
        path = ("controllers", name, "sensor")
        if places is None or not places.alike(springs):
            raise self._scene.error(
                path, f"'{spec.sensor}' reads other places or another strain than this controller commands"
            )
        return (self._sensor(spec.sensor, spec.period, reading, path),)

    def _sensor(self, name: str, period: float, reading: Reading, path: KeyPath) -> Sensor:
        spec = self._scene.scenario.sensors[name]
        late = round(spec.delay / period)
        if abs(late * period - spec.delay) > _ROUNDING * period:
            raise self._scene.error(
                ("sensors", name, "delay"),
                f"{spec.delay:g} s is no multiple of the period of {period:g} s of "
                f"'{path[1]}': readings arrive at samples",
            )
        noise = Noise(spec.noise, spec.seed, name) if spec.noise else None
        return Sensor(name, reading, noise, late)


def _bare(structure: Structure) -> Model:
    """What moves, without anything that acts on it."""
    return Model(
        dofs=structure.dofs,
        rest=structure.rest,
        mass=np.zeros(structure.dofs.n),
        terms=(),
        motions=(),
        frames=structure.frames,
        driver=structure.driver,
        length=1.0,
    )


def _limits(spec: control.Sampled) -> Limits:
    given = spec.limits
    rate = inf if given.rate is None else given.rate * spec.period
    return Limits(inf if given.magnitude is None else given.magnitude, rate)


def _ideal(
    name: str, spec: control.Ideal, springs: Springs, target: Target, first: int
) -> tuple[Loop, Port, int]:
    gains = spec.gains
    integral = Channel(first, springs.n) if gains.i else None
    loop = IdealLoop(
        name=name,
        reading=springs.reading,
        target=target,
        p=gains.p,
        i=gains.i,
        weight=gains.setpoint_weight,
        forward=spec.feed_forward,
        integral=integral,
    )
    share = (spec.feed_forward + gains.p * gains.setpoint_weight) / (1.0 + gains.p)
    port = IdealPort(target, share, integral, gains.p)
    return loop, port, first if integral is None else integral.end
