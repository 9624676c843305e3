"""What a controller is to the natural strains that it commands."""

from __future__ import annotations

from typing import Protocol

from ..arrays import IntArray
from ..frozen import frozen
from ..laws.signal import Signal
from .channel import Channel, Commanded, Stiffened
from .target import Target


class Port(Protocol):
    """Where springs are driven from."""

    @property
    def p(self) -> float:
        """By how many times its own stiffness a spring is stiffer."""

    def signal(self, members: IntArray) -> Signal:
        """What springs follow, by their numbers among those that are commanded, shape (K,)."""


@frozen
class SampledPort:
    """Springs follow a command as they would follow a law.

    Attributes:
        channel: Where it comes from.
        p: 0.
    """

    channel: Channel
    p: float = 0.0

    def signal(self, members: IntArray) -> Signal:
        """The command."""
        return Commanded(self.channel, members)


@frozen
class IdealPort:
    """Springs are 1 + p times as stiff.

    Attributes:
        target: What strains shall be.
        share: Share of the target at which they rest then.
        integral: Channel of what is added to that, or None.
        p: The gain.
    """

    target: Target
    share: float
    integral: Channel | None
    p: float

    def signal(self, members: IntArray) -> Signal:
        """Where they rest."""
        return Stiffened(self.target, self.share, self.integral, members)
