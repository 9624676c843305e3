"""How far steps go along a path of equilibria: further where Newton finds it easily, until its end."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np

from ..frozen import frozen
from ..model.saved import Arrays, Numbers
from ..solve.step_result import StepResult

# Iterations that a step should take, and by how much lengths may change from step to step.
_WANTED, _LEAST_CHANGE, _LARGEST_CHANGE = 6, 0.5, 1.5

IMPERFECTION = "imperfection: {amplitude: 0.1 mm, mode: 1}"
"""What a user may type, with an amplitude of his own."""


@frozen
class PathControl:
    """Where a run stands on its path; implements :class:`~.step_control.StepControl`.

    Attributes:
        length: Of the next step.
        largest: That a step may have.
        steps: Steps after which the path ends in any case.
        max_cuts: How often a step may be halved.
        at: Length of the path so far.
        taken: Steps so far.
        cuts: How often the next step has been halved.
        arrived: Whether the path has come to where it was to end.
        branches: Load factors of the bifurcations passed.
    """

    length: float
    largest: float
    steps: int
    max_cuts: int
    at: float = 0.0
    taken: int = 0
    cuts: int = 0
    arrived: bool = False
    branches: tuple[float, ...] = ()
    closing: ClassVar[bool] = False
    calmer: ClassVar[str] = "reduce numerics.integrator.path.largest"
    finer: ClassVar[str] = "raise numerics.step.max_cuts"

    @property
    def t_end(self) -> float:
        """Length of a path that takes all steps as they are now."""
        return self.at if self.done else self.at + (self.steps - self.taken) * self.length

    @property
    def target(self) -> float:
        """Length of the path at the end of the next step."""
        return self.at + self.length

    @property
    def done(self) -> bool:
        """Whether the path ends here."""
        return self.arrived or self.taken >= self.steps

    @property
    def doubt(self) -> str:
        """That the path ended where it was not to end, or passed where another leaves it."""
        found = []
        if not self.arrived:
            found.append(
                f"the path ends after {self.taken} steps, before it came to where it was to end: raise "
                "numerics.integrator.path.steps"
            )
        if self.branches:
            at = ", ".join(f"{load:.4g}" for load in self.branches[:3])
            found.append(
                f"{len(self.branches)} bifurcations were passed, at load factor {at}: there the robot would "
                f"buckle into another shape; a small imperfection leads there: {IMPERFECTION}"
            )
        return "; ".join(found)

    @property
    def exhausted(self) -> bool:
        """Whether the step is cut as often as it may be."""
        return self.cuts >= self.max_cuts

    def shorter(self, dt: float) -> str:
        """The change to a quarter of a step."""
        return f"numerics.integrator.path.largest={0.25 * dt:.3g}"

    def refused(self, result: StepResult) -> None:
        """None: a step that Newton's method solved may stand."""

    def ahead(self, most: int) -> tuple[float, ...]:
        """None: each step goes as far as the last one allows."""
        return ()

    def passed(self, count: int) -> PathControl:
        """Itself: no steps are ahead."""
        return self

    def accepted(self, result: StepResult) -> PathControl:
        """The control a step on."""
        change = (_WANTED / max(result.iterations, 1)) ** 0.5
        length = self.length * min(max(change, _LEAST_CHANGE), _LARGEST_CHANGE)
        return replace(
            self,
            length=min(length, self.largest),
            at=result.state.t,
            taken=self.taken + 1,
            cuts=max(self.cuts - 1, 0),
            arrived=result.arrived,
            branches=tuple(result.state.memory["path.branches"].tolist()),
        )

    def failed(self) -> PathControl:
        """The control with the next step halved."""
        return replace(self, length=0.5 * self.length, cuts=self.cuts + 1)

    def starting(self, t: float) -> PathControl:
        """This control with that length of path behind it."""
        return replace(self, at=t)

    def joining(self, before: PathControl, t: float) -> PathControl:
        """This control, of a changed scenario, where another stands."""
        return replace(
            self,
            length=min(before.length, self.largest),
            at=before.at,
            taken=before.taken,
            branches=before.branches,
        )

    def arrays(self) -> Arrays:
        """Bifurcations."""
        return {"branches": np.array(self.branches)}

    def numbers(self) -> Numbers:
        """The place on the path."""
        return {
            "length": self.length,
            "at": self.at,
            "taken": self.taken,
            "cuts": self.cuts,
            "arrived": int(self.arrived),
            "done": int(self.done),
        }

    def restore(self, arrays: Arrays, numbers: Numbers) -> PathControl:
        """The control at the place that was saved."""
        return replace(
            self,
            length=float(numbers["length"]),
            at=float(numbers["at"]),
            taken=int(numbers["taken"]),
            cuts=int(numbers["cuts"]),
            arrived=bool(numbers["arrived"]),
            branches=tuple(arrays["branches"].tolist()),
        )
