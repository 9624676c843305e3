"""The energy account of a run: what came in, what went out, what is stored.

Stored energies are measured when asked for; work is summed over every step. The error is what the
time integrator made or lost: kinetic + elastic + gravitational - initial - work + dissipation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..kinematics.motion import moving_dofs
from ..model.model import Model
from ..model.saved import Arrays, Numbers
from ..model.state import State
from ..model.term import BoundEnergy
from ..solve.plain import Steps
from ..solve.step_result import StepResult
from ..solve.system import System
from .growth import Growth
from .roles import Roles
from .stored import Stored
from .work import Known, Work


class EnergyAccount:
    """Sums work over steps; measures stored energies on demand.

    Implements :class:`~dismech_cli.model.saved.Saved`.
    """

    columns: tuple[str, ...] = (
        "external_work",
        "actuation_work",
        "dissipation",
        "friction",
        "initial",
        "largest",
    )

    def __init__(self, model: Model, roles: Roles, start: State) -> None:
        """Account for nothing yet; :meth:`bind` comes first."""
        self._model = model
        self._roles = roles
        self._start = start
        self._growth = Growth.of(model)
        self._last: Known | None = None
        self._stored: Stored
        self._work: Work
        self._actuated: Sequence[BoundEnergy] = ()
        self._changing: Sequence[BoundEnergy] = ()
        self._pushed: Sequence[BoundEnergy] = ()
        if roles.surplus:
            self.columns = (*self.columns, "surplus")
        self.sums = dict.fromkeys(self.columns, 0.0)
        # what was known of the state that was restored
        self._restored: Arrays = {}
        # the sums at the start of the last step, and its ends
        self._before, self._span = dict(self.sums), (0.0, 0.0)

    def bind(self, system: System, t: float) -> None:
        """Use the bound terms of a system from time ``t`` [s] on, with the DOFs that are held then."""
        model, roles = self._model, self._roles
        moving = moving_dofs(model.motions, self._start.q, self._start.v, t)
        self._last, self._restored = None, {}
        self._work = Work(model, roles, system, moving)
        self._stored = stored = Stored.of(model, roles, system)
        self._actuated = [term for term in stored.elastic if not term.steady]
        self._changing = [term for term in stored.gravitational if not term.steady]
        self._pushed = [term for term in stored.contact if not term.steady]

    def start(self, state: State) -> None:
        """Take the stored energy of ``state`` as the zero of the account."""
        self.sums["initial"] = 0.0
        if self._roles.surplus:
            self.sums["surplus"] = self._stored.fed(self._see(state).at(state))
        self.sums["initial"] = self.measure(state)["error"]

    def at_ease(self, *, balanced: bool) -> bool:
        """Whether steps need not be booked one by one.

        Args:
            balanced: Whether they end in balance.
        """
        busy = self._actuated or self._changing or self._pushed
        return not busy and self._work.of_ends(balanced=balanced)

    def leap(self, before: State, steps: Steps, result: StepResult) -> None:
        """Book the work of many steps from a state to the last result, where the account is at ease."""
        # one by one, so that a run that is resumed within them sums up the same
        *works, last = self._work.of_leap(self._see(before), steps).tolist()
        for work in works:
            self.sums["external_work"] += work
        self._before, self._span = dict(self.sums), (steps.times[-2], result.state.t)
        self.sums["external_work"] += last
        self.meet(result)

    def meet(self, result: StepResult) -> Known:
        """Remember what a step tells of its end."""
        resistance = self._work.reacted(result.reactions)
        self._last = Known(result.state, self._model.frames, resistance, result.auxiliary)
        return self._last

    def advance(self, before: State, result: StepResult) -> None:
        """Book the work of a step from a state."""
        work, sums, after, put_in = self._work, self.sums, result.state, result.put_in
        self._before, self._span = dict(sums), (before.t, after.t)
        if put_in:
            self._last = None  # it was seen with other terms
            sums["external_work"] += put_in
        start = self._see(before)
        end = self.meet(result)
        parts = work.parts(start, result.trail[1:-1], end)
        sums["external_work"] += work.of_holds(start, end, parts)
        loads, dissipated, rubbed = work.of_forces(before, after, parts)
        sums["external_work"] += loads
        sums["dissipation"] += dissipated + rubbed
        sums["friction"] += rubbed
        sums["actuation_work"] += work.in_time(self._actuated, start, end)
        sums["external_work"] += work.in_time(self._changing, start, end)
        sums["external_work"] += work.by_movers(self._pushed, start, end)

    def put_in(self, before: State, after: State) -> None:
        """Book the work of what is put in at once: both states have the same shape and time."""
        self.sums["actuation_work"] += self._work.in_time(
            self._actuated, self._see(before), Known(after, self._model.frames)
        )

    def measure(self, state: State) -> Mapping[str, float]:
        """All entries of the account at ``state`` [J]; within a step, work as if done evenly."""
        c = self._see(state).at(state)
        entries, s = self._stored.at(c), self._sums_at(state.t)
        entries["external_work"] = s["external_work"] + s["actuation_work"]
        if self._roles.surplus:
            # what feedback stores in passive springs beyond stiffer ones, it has put in
            entries["external_work"] += self._stored.fed(c) - s["surplus"]
        entries["dissipation"] = s["dissipation"]
        entries["friction"] = s["friction"]
        entries["error"] = entries["total"] - s["initial"] - entries["external_work"] + s["dissipation"]
        s = self.sums
        s["largest"] = max(s["largest"], entries["kinetic"] + abs(entries["elastic"] + entries["contact"]))
        return entries

    def arrays(self) -> Arrays:
        """What is known of the state: found otherwise it would be rounded otherwise."""
        if self._last is None:
            return {}
        known = {"resistance": self._last.resistance, "auxiliary": self._last.auxiliary}
        return {name: values for name, values in known.items() if values is not None}

    def numbers(self) -> Numbers:
        """The sums."""
        return self.sums

    def restore(self, arrays: Arrays, numbers: Numbers) -> EnergyAccount:
        """Go on from the sums that were saved."""
        self.sums = {name: float(numbers[name]) for name in self.columns}
        self._restored = dict(arrays)
        return self

    def growth(self, entries: Mapping[str, float], seconds: float) -> float:
        """Energy from nowhere in what :meth:`measure` gave, as a share of all in a run of ``seconds``."""
        return self._growth.share(entries, self.sums["largest"], seconds)

    def runs_away(self, entries: Mapping[str, float], seconds: float) -> bool:
        """Whether that is far more than the robot was given."""
        return self._growth.runs_away(entries, self.sums["initial"], seconds)

    def _sums_at(self, t: float) -> Mapping[str, float]:
        """The sums at a time [s] of the last step."""
        start, end = self._span
        if not start < t < end:
            return self.sums
        ahead = (end - t) / (end - start)
        return {name: late - ahead * (late - self._before[name]) for name, late in self.sums.items()}

    def _see(self, state: State) -> Known:
        """What is known of a state; a step begins at the end of the last one."""
        if self._last is None or self._last.state is not state:
            self._last = Known(
                state, self._model.frames, self._restored.get("resistance"), self._restored.get("auxiliary")
            )
            self._restored = {}
        return self._last
