"""Turns accepted states into frames and watched values; computes nothing that is not asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

from ..arrays import FloatArray
from ..model.configuration import Configuration
from ..model.state import State
from ..output.frame import Frame
from ..solve.linear.factors import FactorizationError
from ..solve.step import Stepper
from .account import EnergyAccount
from .between import between
from .observables.probes import Probe
from .observables.snapshot import Snapshot
from .roles import Roles
from .simulation import Simulation

ENERGY_COLUMNS = (
    "kinetic",
    "elastic",
    "gravitational",
    "external_work",
    "dissipation",
    "error",
)

Singular: TypeAlias = tuple[float, int, ArithmeticError]
"""Where eigenvalues could not be counted: time, the DOF to look at, and why."""


LOAD_COLUMNS: Mapping[str, str] = {"load_factor": "1"}
"""What runs whose time is not the load factor have beside it."""


def scalar_columns(
    roles: Roles, probes: Mapping[str, Probe], more: Mapping[str, str] = MappingProxyType({})
) -> dict[str, str]:
    """Names and units of the scalar table, in order.

    Args:
        roles: Terms of the model.
        probes: Columns that are asked for.
        more: Columns of this kind of run.
    """
    columns = {"dt": "s", "newton_iterations": "1", "residual": "N", **more}
    columns |= dict.fromkeys(ENERGY_COLUMNS[:2], "J")
    columns |= {f"elastic_{name}": "J" for name in roles.shares}
    columns |= dict.fromkeys(ENERGY_COLUMNS[2:], "J")
    columns |= dict.fromkeys(contact_columns(roles), "J")
    columns |= {"max_speed": "m/s", "wall": "s"}
    return columns | {name: probe.unit for name, probe in probes.items()}


def contact_columns(roles: Roles) -> tuple[str, ...]:
    """Entries of the account that only scenes with contact and with friction have."""
    return (*(["contact"] if roles.contact else []), *(["friction"] if roles.friction else []))


class Observer:
    """Looks at the states of one run."""

    def __init__(
        self,
        simulation: Simulation,
        stepper: Stepper,
        account: EnergyAccount,
        tell_singular: Callable[[Singular], None],
    ) -> None:
        """Look at nothing yet.

        Args:
            simulation: What is run.
            stepper: Takes its steps.
            account: Energies and work.
            tell_singular: Told once why eigenvalues cannot be counted.
        """
        self._simulation = simulation
        self._stepper = stepper
        self._account = account
        self._tell_singular = tell_singular
        self._singular = False
        self._elastic = {term.name: term for term in simulation.roles.elastic}

    def snapshot(self, state: State, residual: FloatArray) -> Snapshot:
        """Wrap a state."""
        measure: Callable[[], Mapping[str, float]] = lambda: self._account.measure(state)  # noqa: E731
        return Snapshot(
            self._simulation.model,
            state,
            residual,
            measure,
            lambda: self._count_negative(state),
            lambda name: self._stencil_energies(name, state),
            lambda name: self._elastic[name].natural_at(state.law_time, state.inputs),
            lambda: self._stepper.system.touch(state),
        )

    def between(self, before: State, after: State, t: float) -> State:
        """The state at a time [s] within a step."""
        return between(before, after, t, self._simulation.model.frames)

    def _count_negative(self, state: State) -> float:
        """The run goes on where the tangent has no inertia: it is the probe that has no value."""
        try:
            return float(self._stepper.stability.negative_eigenvalues(state))
        except FactorizationError as error:
            if not self._singular:
                self._singular = True
                self._tell_singular((state.t, self._stepper.stability.softest(state), error))
            return float("nan")

    def _stencil_energies(self, name: str, state: State) -> FloatArray:
        (term,) = (term for term in self._stepper.system.energies if term.name == name)
        frames = self._simulation.model.frames.transport(state.frames, state.q)
        c = Configuration(state.law_time, state.q, state.v, frames, state.inputs)
        energies: FloatArray = term.energy(c).sum(axis=0)
        return energies

    def frame(
        self, index: int, s: Snapshot, dt: float, iterations: int, residual_norm: float, wall: float
    ) -> Frame:
        """Build a frame."""
        visible = self._simulation.model.dofs.visible
        energies = s.energies
        scalars = {"dt": dt, "newton_iterations": float(iterations), "residual": residual_norm, "wall": wall}
        scalars["load_factor"] = s.state.law_time
        scalars |= {name: energies[name] for name in ENERGY_COLUMNS}
        scalars |= {name: energies[name] for name in contact_columns(self._simulation.roles)}
        scalars |= {f"elastic_{name}": energies[name] for name in self._simulation.roles.shares}
        v = s.dofs.positions(s.state.v)[:visible]
        scalars["max_speed"] = float((v * v).sum(axis=1).max()) ** 0.5
        scalars |= {name: probe(s) for name, probe in self._simulation.probes.items()}
        return Frame(
            index=index,
            t=s.state.t,
            positions=s.positions[:visible],
            fields={field.spec.name: field(s) for field in self._simulation.fields},
            state=self._state_arrays(s),
            scalars={name: scalars[name] for name in self._simulation.topology.scalars},
        )

    def _state_arrays(self, s: Snapshot) -> dict[str, FloatArray]:
        return {"q": s.state.q, "v": s.state.v}
