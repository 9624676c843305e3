"""What strains are, asked of the energies themselves: only they know what they call a strain."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver, StencilLoop
from ..kinematics.rod_frames import Frames, TrialFrames
from .state import State
from .stencil import StencilEnergy

# By how much natural strains are moved: energies are quadratic in them, so any step is exact but for
# rounding, which is least near the size of strains.
_STEP: Final = 0.1
# Weights below this share of the largest are rounding.
_COUPLED: Final = 1e-9


@frozen
class NoPattern:
    """Where no entry has a place: for loops that are asked for energies alone.

    Attributes:
        n: Number of DOFs, all of them fixed.
    """

    n: int

    @property
    def slots(self) -> int:
        """The spare one."""
        return 1

    @property
    def order(self) -> IntArray:
        """No DOF has a row, shape (n,)."""
        return np.full(self.n, -1)

    @property
    def indptr(self) -> IntArray:
        """No rows, shape (1,)."""
        return np.zeros(1, dtype=np.int64)

    @property
    def indices(self) -> IntArray:
        """No entries, shape (0,)."""
        return np.empty(0, dtype=np.int64)

    def symmetric_slots(self, i: IntArray, j: IntArray) -> IntArray:
        """The spare slot for all."""
        return np.zeros(np.broadcast_shapes(i.shape, j.shape), dtype=np.int64)

    def slots_of(self, row: IntArray, column: IntArray) -> IntArray:
        """The spare slot for all."""
        return np.zeros(np.broadcast_shapes(row.shape, column.shape), dtype=np.int64)


@frozen
class StrainReading:
    """Strains of some stencils beyond their natural ones, each a sum over what its kernel calls strains.

    The slope of an energy to its natural strains is -C (e - e0), with a constant C.

    Attributes:
        frames: Kinematics of material frames.
        loop: Energies of the stencils.
        parameters: Theirs, shape (P, S).
        weights: What to sum: weights of C (e - e0) by natural strain, shape (N, S).
    """

    frames: Frames
    loop: StencilLoop
    parameters: FloatArray
    weights: FloatArray

    @classmethod
    def of(
        cls, energy: StencilEnergy, frames: Frames, driver: Driver, rest: FloatArray, modes: FloatArray
    ) -> StrainReading:
        """Read the first of some ways to strain in every stencil of an energy.

        Where strains act on each other, it is the way that goes with the others best, in energy.

        Args:
            energy: The energy; a stencil without stiffness has no strain.
            frames: Kinematics of material frames.
            driver: Runs the kernel.
            rest: A configuration q, shape (n,).
            modes: What a unit of each way is of each strain of the kernel, shape (K, N, S).
        """
        loop = driver.stencil(energy.kernel, energy.dofs, energy.auxiliaries, NoPattern(len(rest)))
        trial = frames.transport(frames.rest(rest), rest)
        stiffness = _stiffness(loop, energy, trial, rest)
        ways = modes.transpose(2, 1, 0)
        compliance = np.linalg.pinv(ways.transpose(0, 2, 1) @ stiffness @ ways, hermitian=True)
        weights = (ways @ compliance)[:, :, 0].T
        # strains that do not act on each other do so by rounding alone
        weights = np.where(np.abs(weights) > _COUPLED * np.abs(weights).max(axis=0), weights, 0.0)
        return cls(frames, loop, energy.parameters, np.ascontiguousarray(weights))

    @property
    def size(self) -> int:
        """Number of stencils."""
        return len(self.parameters.T)

    def __call__(self, state: State) -> FloatArray:
        """The strains at a state, shape (S,)."""
        return self.at(state.q, self.frames.transport(state.frames, state.q))

    def at(self, q: FloatArray, trial: TrialFrames) -> FloatArray:
        """The strains of a configuration, shape (S,)."""
        out = np.zeros(self.size)
        for row, weight in enumerate(self.weights):
            if not weight.any():
                continue
            less, more = (
                _moved(self.loop, self.parameters, q, trial, {row: sign * _STEP}) for sign in (-1.0, 1.0)
            )
            out += weight * (less - more) / (2.0 * _STEP)
        return out


def _stiffness(loop: StencilLoop, energy: StencilEnergy, trial: TrialFrames, q: FloatArray) -> FloatArray:
    """Second derivatives C to the natural strains, shape (S, N, N)."""
    n, s = len(energy.kernel.naturals), len(energy.dofs)
    here = _moved(loop, energy.parameters, q, trial, {})
    one = [_moved(loop, energy.parameters, q, trial, {i: _STEP}) for i in range(n)]
    back = [_moved(loop, energy.parameters, q, trial, {i: -_STEP}) for i in range(n)]
    out = np.empty((s, n, n))
    for i in range(n):
        out[:, i, i] = (one[i] + back[i] - 2.0 * here) / _STEP**2
        for j in range(i):
            both = _moved(loop, energy.parameters, q, trial, {i: _STEP, j: _STEP})
            out[:, i, j] = out[:, j, i] = (both - one[i] - one[j] + here) / _STEP**2
    return out


def _moved(
    loop: StencilLoop, parameters: FloatArray, q: FloatArray, trial: TrialFrames, by: dict[int, float]
) -> FloatArray:
    """Energies with some natural strains moved, shape (S,)."""
    moved = parameters.copy()
    for row, step in by.items():
        moved[row] += step
    energies: FloatArray = loop.energy(q, trial.auxiliary, moved).sum(axis=0)
    return energies
