"""What driven springs follow: a law, or what a controller commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, TypeAlias

from ...arrays import IntArray
from ...laws.signal import Signal
from ...scenario.language.actuation import Controlled, Driven
from ..laws import Coordinates
from ..scene import Scene

if TYPE_CHECKING:
    from ...control.port import Port

Ports: TypeAlias = "Mapping[int, Port]"
"""Where controlled springs are driven from, by the number of their actuation."""

Following: TypeAlias = Callable[[IntArray, Coordinates], Signal]
"""What springs follow, from their numbers among those that are driven and from where they are."""


def following(scene: Scene, ports: Ports, index: int, value: Driven) -> Following:
    """What the springs of an actuation follow.

    Args:
        scene: The scene.
        ports: Of the controllers.
        index: Number of the actuation.
        value: As it says.
    """
    if isinstance(value, Controlled):
        port = ports[index]
        return lambda members, at: port.signal(members)
    return lambda members, at: scene.laws(value, at)
