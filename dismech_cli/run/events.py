"""What a run tells of its steps as they go on."""

from __future__ import annotations

from ..frozen import frozen
from ..model.state import State
from ..solve.status import Status
from .simulation import Simulation
from .sink import Sink


@frozen
class Events:
    """Tells a sink what happens at steps.

    Attributes:
        sink: Where events go.
        simulation: What is run.
    """

    sink: Sink
    simulation: Simulation

    def cut(self, t: float, target: float, status: Status) -> None:
        """A step from ``t`` to ``target`` [s] failed."""
        self.sink.event("step_cut", t, dt=target - t, status=status.name)

    def refused(self, t: float, end: float) -> None:
        """A step from ``t`` to ``end`` [s] was not accurate."""
        self.sink.event("step_refused", t, dt=end - t)

    def ambiguous(self, t: float, end: float) -> None:
        """A step from ``t`` to ``end`` [s] that was taken has more than one solution."""
        self.sink.event("ambiguous_step", end, dt=end - t)

    def contact(self, before: State, after: State) -> bool:
        """What happened to contact in a step; whether pairs came to places in the matrix, or lost them."""
        touched = self.simulation.touched
        if touched is None:
            return False
        if (rebuilt := touched.rebuilt(before, after)) is not None:
            self.sink.event("contact_rebuilt", after.t, **rebuilt)
        if (found := touched.too_deep(before, after)) is not None:
            near = self.simulation.places[found.node]
            self.sink.event("penetration", after.t, between=found.pair, share=found.share, near=near)
        return rebuilt is not None
