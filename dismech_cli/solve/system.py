"""A model bound to a sparsity pattern: residual, tangent and potential of a stage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..model.configuration import Configuration
from ..model.frames import FrameState
from ..model.model import Model
from ..model.term import BoundEnergy, BoundTerm, Linearization
from .integrators import Stage
from .pattern import SparsityPattern

_EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True)
class Balance:
    """The residual at a trial point, with the sizes that say when it is small.

    Attributes:
        residual: M a + r, shape (n,); reactions on held DOFs.
        force: Largest force that any term or partial sum of terms exerts on a DOF [N].
        moment: The same for angles [N m].
    """

    residual: FloatArray
    force: float
    moment: float


class System:
    """All terms bound to one pattern, with the buffers of assembly."""

    def __init__(self, model: Model, free: BoolArray) -> None:
        self.model = model
        self.pattern = SparsityPattern.build(
            model.dofs, free, [coupling for term in model.terms for coupling in term.couplings]
        )
        # Symmetric tangents fill one triangle; it is mirrored before the others are added.
        symmetric = [t for t in model.terms if all(c.symmetric for c in t.couplings)]
        general = [t for t in model.terms if not all(c.symmetric for c in t.couplings)]
        self._symmetric = [t.bind(self.pattern, model.driver) for t in symmetric]
        self._general = [t.bind(self.pattern, model.driver) for t in general]
        self._mirror = None if self.pattern.symmetric else self.pattern.mirror()
        self._damped = any(t.dissipative for t in model.terms)
        self._buffers = Linearization.of(model.dofs.n, self.pattern.slots)
        self._free_mass = model.mass[self.pattern.free]
        self._has_mass = bool(model.mass.any())

    @property
    def terms(self) -> tuple[BoundTerm, ...]:
        """Every bound term."""
        return (*self._symmetric, *self._general)

    def configuration(self, stage: Stage, q: FloatArray, stored: FrameState) -> Configuration:
        """Evaluate the trial point of a stage."""
        position = stage.position(q)
        return Configuration(
            stage.t_stage,
            position,
            stage.velocity(q),
            self.model.frames.transport(stored, position),
        )

    def balance(self, stage: Stage, q: FloatArray, stored: FrameState) -> Balance:
        """Residual only, with the force scale."""
        c = self.configuration(stage, q, stored)
        split = self.model.dofs.n_positions
        r = self.model.mass * stage.acceleration(q) if self._has_mass else np.zeros_like(q)
        force, moment = _largest(r[:split]), _largest(r[split:])
        for term in self.terms:
            term.add_residual(c, r)
            force = max(force, _largest(r[:split]))
            moment = max(moment, _largest(r[split:]))
        return Balance(r, force, moment)

    def linearize(self, stage: Stage, q: FloatArray, stored: FrameState) -> tuple[FloatArray, FloatArray]:
        """Residual (n,) and tangent values (slots,) of a stage; both are reused buffers."""
        c = self.configuration(stage, q, stored)
        into, w = self._buffers, stage.weights
        into.residual[:] = 0.0
        into.stiffness[:] = 0.0
        for term in self._symmetric:
            term.add_linearization(c, into)
        if self._mirror is not None:
            lower, upper = self._mirror
            into.stiffness[lower] = into.stiffness[upper]
        if self._damped:
            into.damping[:] = 0.0
        for term in self._general:
            term.add_linearization(c, into)
        values = into.stiffness
        if w.q != 1.0:
            values *= w.q
        if self._damped:
            values += w.v * into.damping
        if self._has_mass:
            into.residual += self.model.mass * stage.acceleration(q)
            values[self.pattern.diagonal] += w.a * self._free_mass
        return into.residual, values

    def potential(self, stage: Stage, q: FloatArray, stored: FrameState) -> tuple[float, FloatArray]:
        """Energy [J] of all potential terms at the stage, and the rest of the residual (n,).

        Divided by the stage's position weight the energy is the potential part of the stage's
        merit function; the rest (inertia, drag) is integrated along a search direction.
        """
        c = self.configuration(stage, q, stored)
        energy = 0.0
        rest = self.model.mass * stage.acceleration(q)
        for term in self.terms:
            if isinstance(term, BoundEnergy):
                energy += float(term.energy(c).sum())
            else:
                term.add_residual(c, rest)
        return energy, rest

    def round_off(self, values: FloatArray, q: FloatArray) -> float:
        """Size of the residual that rounding of positions alone explains [N]."""
        split = self.model.dofs.n_positions
        diagonal = values[self.pattern.diagonal][self.pattern.free < split]
        return 2.0 * _EPS * _largest(diagonal) * _largest(q[:split])


def _largest(x: FloatArray) -> float:
    return max(float(x.max()), -float(x.min())) if x.size else 0.0
