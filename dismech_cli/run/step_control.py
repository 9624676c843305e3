"""What decides how far a step goes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, Self

from ..model.saved import Saved
from ..solve.step_result import StepResult


class StepControl(Saved, Protocol):
    """Where a run stands between start and end, and where its next step shall end; frozen."""

    @property
    def t_end(self) -> float:
        """End of the run [s]."""

    @property
    def steps(self) -> int:
        """How many steps the run takes if all goes as planned."""

    @property
    def target(self) -> float:
        """Time [s] at the end of the next step."""

    @property
    def done(self) -> bool:
        """Whether the end of the run is reached."""

    @property
    def doubt(self) -> str:
        """Why the run has not come to the end that it was to come to; empty if it has."""

    @property
    def exhausted(self) -> bool:
        """Whether the next step is as short as a step may be: if it fails, the run does."""

    @property
    def closing(self) -> bool:
        """Whether the next step may be another one if the run had a later end."""

    @property
    def calmer(self) -> str:
        """What a user may do for shorter steps, in words."""

    @property
    def finer(self) -> str:
        """What lets steps be cut further, in words."""

    def shorter(self, dt: float) -> str:
        """The change of the scenario that makes steps of ``dt`` [s] shorter, as ``KEY=VALUE``."""

    def starting(self, t: float) -> Self:
        """This control, of a changed scenario, at time ``t`` [s] of a run that was controlled otherwise."""

    def joining(self, before: Self, t: float) -> Self:
        """This control, of a changed scenario, where another stands at time ``t`` [s]."""

    def refused(self, result: StepResult) -> Self | None:
        """The control with a shorter step if one that reached its target is no good; None if it is."""

    def ahead(self, most: int) -> Sequence[float]:
        """Ends [s] of the next steps if all go well, whatever comes of them: at most so many, or none."""

    def passed(self, count: int) -> Self:
        """The control after as many of the steps that were ahead."""

    def accepted(self, result: StepResult) -> Self:
        """The control after a step that reached its target."""

    def failed(self) -> Self:
        """The control with the next step shortened."""
