"""Loads at which shipped scenes lose their stability, by bisection."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from .row import Row, RunError, command, verdicts

# Share of the load to which it is found.
_RESOLVED: Final = 1e-5
_COUNTED: Final = (
    "numerics.integrator.load_steps=1",
    "expect={unstable: {probe: {negative_eigenvalues: true}, value: 0, tolerance: 0, source: none}}",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Threshold:
    """The load at which the stiffness is not positive any more; implements :class:`~.row.Case`.

    Attributes:
        file: Name of the scenario, from `scenarios/` on.
        loaded: What is set in it for a load.
        quantity: What the load is, in which units.
        value: The published load.
        tolerance: Greatest deviation, as a share.
        source: Of the value.
        bracket: Share of the value within which it is sought.
    """

    file: str
    loaded: Callable[[float], tuple[str, ...]]
    quantity: str
    value: float
    tolerance: float
    source: str
    bracket: float = 0.06

    def rows(self) -> list[Row]:
        """Seek it.

        Raises:
            RunError: A run does not come to its end, or the load is not within the bracket.
        """
        low, high = (self.value * (1.0 + side * self.bracket) for side in (-1.0, 1.0))
        if not self._stable(low) or self._stable(high):
            raise RunError(f"{self.file}: stability is not lost between {low:.6g} and {high:.6g}")
        while high - low > _RESOLVED * self.value:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._stable(middle) else (low, middle)
        here = 0.5 * (low + high)
        met = abs(here / self.value - 1.0) <= self.tolerance
        line = command(self.file, self.loaded(round(self.value, 6)))
        tolerance = f"{100.0 * self.tolerance:g} %"
        return [Row(line, self.quantity, self.value, here, "", tolerance, self.source, met)]

    def _stable(self, load: float) -> bool:
        (count,) = verdicts(self.file, (*self.loaded(load), *_COUNTED))
        return count.measured == 0.0
