"""Loops of the scenario; a scene without controllers and sensors loads nothing that they are made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from typing import TYPE_CHECKING, TypeAlias

from ...control.loop import UNCONTROLLED, Controls, Loop
from ...control.plugin import Plugins
from ...frozen import frozen
from ...run.observables.probes import Probe
from ...scenario.language.probe import Probe as ProbeSpec
from ...scenario.text.tree import KeyPath
from ..elastic.elastic import Passive
from ..elastic.following import Ports
from ..scene import Scene
from ..structure.structure import Structure

if TYPE_CHECKING:
    from ...control.sensor import Reading
    from ...control.target import Target
    from .springs import Springs

MakeProbe: TypeAlias = Callable[[ProbeSpec, KeyPath], Probe]


@frozen(kw_only=True)
class Control:
    """All loops of a scene.

    Attributes:
        controls: What acts between steps.
        ports: What drives springs, by the number of their actuation.
        size: Number of inputs.
        events: Times of samples up to the end of the run [s], ascending.
        springs: What each controller drives, by its name.
        targets: What it is to reach.
        loops: The loop of each.
        readings: What each sensor reads, by its name, without noise and delay.
        kept: Files that stand for the folders of runs that are followed, by the names of these.
    """

    controls: Controls = UNCONTROLLED
    ports: Ports
    size: int = 0
    events: tuple[float, ...] = ()
    springs: Mapping[str, Springs]
    targets: Mapping[str, Target]
    loops: Mapping[str, Loop]
    readings: Mapping[str, Reading]
    kept: Mapping[str, bytes] = field(default_factory=dict)


NO_CONTROL = Control(ports={}, springs={}, targets={}, loops={}, readings={})
"""That of a scene without controllers and sensors."""


def make_control(
    scene: Scene,
    structure: Structure,
    passive: Passive,
    plugins: Plugins,
    make_probe: MakeProbe,
) -> Control:
    """All loops of a scene.

    Args:
        scene: The scene.
        structure: What moves.
        passive: Elastic energies before anything drives them.
        plugins: Where controllers of plugins come from.
        make_probe: Puts the probe of a sensor on its place.

    Raises:
        ScenarioError: Something does not fit.
    """
    if not scene.scenario.controllers and not scene.scenario.sensors:
        return NO_CONTROL
    from .loops import make_loops

    return make_loops(scene, structure, passive, plugins, make_probe)
