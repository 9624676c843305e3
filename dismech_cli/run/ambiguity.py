"""Steps that had more than one solution and could not be cut any more: one of them was taken."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.saved import Arrays, Numbers


@dataclass(slots=True)
class Ambiguity:
    """Counts such steps; implements :class:`~dismech_cli.model.saved.Saved`.

    Attributes:
        steps: How many.
        first: End of the first of them [s].
    """

    steps: int = 0
    first: float = 0.0

    def taken(self, t: float) -> None:
        """Count a step up to ``t`` [s]."""
        self.first = self.first if self.steps else t
        self.steps += 1

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def numbers(self) -> Numbers:
        """Both."""
        return {"steps": self.steps, "first": self.first}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Ambiguity:
        """Count on from what was saved."""
        return Ambiguity(int(numbers["steps"]), float(numbers["first"]))
