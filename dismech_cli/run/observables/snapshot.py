"""What observers see: one accepted state, with derived quantities computed when first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isfinite

from ...arrays import FloatArray, IntArray
from ...kinematics.dofs import DofMap
from ...kinematics.rod_frames import TrialFrames
from ...kinematics.strains import curvature_binormal
from ...model.model import Model
from ...model.state import State
from ...model.touch import Touch


@dataclass(frozen=True)
class Snapshot:
    """One accepted state.

    Attributes:
        model: The system.
        state: The state.
        residual: M a + r of the last solve, shape (n,): on held DOFs the force that holds them.
        measure_energies: Gives the energy account [J] by name.
        count_negative: Gives the number of negative eigenvalues of the stiffness, NaN if it is singular.
        stencil_energies: Gives the energy of each stencil of a named energy [J], shape (S,).
        touching: Gives what touches, pair by pair.
        natural: Gives the natural strains of a named energy at the time of the state, shape (naturals, S).
    """

    model: Model
    state: State
    residual: FloatArray
    measure_energies: Callable[[], Mapping[str, float]]
    count_negative: Callable[[], float]
    stencil_energies: Callable[[str], FloatArray]
    natural: Callable[[str], FloatArray]
    touching: Callable[[], tuple[Touch, ...]]

    @property
    def dofs(self) -> DofMap:
        """Numbering."""
        return self.model.dofs

    @cached_property
    def positions(self) -> FloatArray:
        """Space positions of all nodes [m], walls included, shape (n_nodes, 3)."""
        return self.dofs.space_positions(self.state.q)

    def binormals(self, triples: IntArray) -> FloatArray:
        """Integrated curvature binormals (J, 3) of joints (J, 3), which fields of the same joints share."""
        known = self._binormals.get(id(triples))
        if known is None:
            # with the triples, so that no others can lie where they did
            known = self._binormals[id(triples)] = triples, curvature_binormal(self.positions, triples)
        return known[1]

    @cached_property
    def _binormals(self) -> dict[int, tuple[IntArray, FloatArray]]:
        return {}

    @cached_property
    def velocities(self) -> FloatArray:
        """Space velocities [m/s], shape (n_nodes, 3)."""
        return self.dofs.embed(self.dofs.positions(self.state.v))

    @cached_property
    def forces(self) -> FloatArray:
        """Residual on the nodes [N], shape (n_nodes, 3)."""
        return self.dofs.embed(self.dofs.positions(self.residual))

    @cached_property
    def frames(self) -> TrialFrames:
        """Material frames at the state."""
        return self.model.frames.transport(self.state.frames, self.state.q)

    @cached_property
    def energies(self) -> Mapping[str, float]:
        """Energy account [J] by name."""
        return self.measure_energies()

    @cached_property
    def touches(self) -> Mapping[tuple[str, str], tuple[Touch, int]]:
        """What touches, and the number of the pair in it, by the names of the pair."""
        return {pair: (touch, k) for touch in self.touching() for k, pair in enumerate(touch.pairs)}

    @property
    def finite(self) -> bool:
        """Whether every energy is a number."""
        return all(isfinite(energy) for energy in self.energies.values())

    @cached_property
    def negative_eigenvalues(self) -> float:
        """Negative eigenvalues of the stiffness matrix, NaN if it is singular."""
        return self.count_negative()
