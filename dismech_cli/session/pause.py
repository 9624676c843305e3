"""When to pause, as a user says it."""

from __future__ import annotations

from ..errors import ScenarioError
from ..frozen import frozen
from ..quantities import QuantityError, parse_quantity
from ..run.loop import Limits
from ..units import KINDS


@frozen
class Pause:
    """When to pause, as given.

    Attributes:
        until: Simulated time with unit, or None.
        wall: Wall time [s], or None.
        checkpoint_every: Wall time between checkpoints [s].
    """

    until: str | None
    wall: float | None
    checkpoint_every: float

    def limits(self) -> Limits:
        """The same for the run loop.

        Raises:
            ScenarioError: The time is no time.
        """
        return Limits(
            checkpoint_every=self.checkpoint_every,
            wall=float("inf") if self.wall is None else self.wall,
            until=float("inf") if self.until is None else _seconds(self.until),
        )


def _seconds(text: str) -> float:
    try:
        until = parse_quantity(text, KINDS["time"])
    except QuantityError as error:
        raise ScenarioError(f"--until {text!r}: {error}") from None
    if until <= 0.0:
        raise ScenarioError(f"--until {text!r}: expected a time above zero")
    # The sum of many steps may fall short of the time by rounding.
    return until * (1.0 - 1e-12)
