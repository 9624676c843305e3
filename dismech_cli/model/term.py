"""Protocols of the semi-discrete system M a + r(q, v, t) = 0.

A term is three things: which DOFs it couples, its share of the residual, its tangent blocks. It
is bound once to a sparsity pattern and then only adds numbers into arrays. One sign convention:
the residual share is +dE/dq of an energy and -f of a force.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol, TypeAlias

from ..arrays import FloatArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from .configuration import Configuration
from .touch import Touch

Memory: TypeAlias = Mapping[str, FloatArray]
"""What a step leaves to the next, by name."""


class BoundTerm(Protocol):
    """A term that knows its place in the matrix."""

    @property
    def name(self) -> str:
        """Unique name, e.g. ``"beam.stretch"``; it labels, it never chooses behaviour."""

    @property
    def potential(self) -> BoundEnergy | None:
        """This term as the gradient of an energy; None where it is none."""

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add the residual share to ``r``, shape (n,) [N, N m]."""

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add residual and tangent values."""


class BoundEnergy(BoundTerm, Protocol):
    """A bound term whose residual is the gradient of an energy at fixed time."""

    @property
    def shares(self) -> tuple[str, ...]:
        """Names of the parts of the energy in the account."""

    @property
    def steady(self) -> bool:
        """Whether the energy of a shape is the same at all times and under all inputs."""

    def energy(self, c: Configuration) -> FloatArray:
        """Energies [J], shape (shares, S): a row per part, a column per stencil."""


class BoundChanging(BoundTerm, Protocol):
    """A bound term whose stencils come and go as the robot moves; its name and shares stay."""

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric, whatever the stencils."""

    def place(self, pattern: Pattern) -> None:
        """Look the matrix positions of the present couplings up in a pattern that has them."""

    def heat(self, c: Configuration, v: FloatArray) -> float:
        """Power that its forces at ``c`` turn into heat at velocities (n,) [W]."""

    def add_convex_linearization(self, c: Configuration, into: Linearization) -> None:
        """The same with a tangent that is positive semi-definite, or as near to that as the term can."""


class ChangingSet(Protocol):
    """Bound terms that share their stencils, which come and go."""

    @property
    def terms(self) -> tuple[BoundChanging, ...]:
        """The terms."""

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """DOF cliques of the stencils that are there now; the same objects as long as they do not change."""

    def recall(self, memory: Memory) -> None:
        """Take up what the last step left, as :meth:`memory` gave it; empty at the start of a run."""

    def begin(self, start: Configuration, dt: float) -> None:
        """Make ready for a step of ``dt`` [s]."""

    def detect(self, c: Configuration) -> bool:
        """Find the stencils at a trial point; True if their couplings changed."""

    def longest_step(self, start: Configuration, end: Configuration) -> float:
        """Part in (0, 1] of the way from ``start`` to ``end`` on which nothing passes through anything."""

    def reverses(self, start: Configuration, end: Configuration) -> bool:
        """Whether friction turns round on the way between two trial points: full steps may then swing."""

    def settle(self, end: Configuration) -> bool:
        """Whether a step that ended here may stand; if not, it must be taken again, otherwise by now."""

    def take_back(self) -> None:
        """Undo the last change of :meth:`settle`: the step that it asked for fails."""

    def put_in(self, start: Configuration) -> float:
        """Energy that the changes of this step put in at its start [J]."""

    def memory(self) -> Memory:
        """What the next step depends on, by name."""

    def touch(self, c: Configuration) -> Touch:
        """What touches at a state."""


class ChangingTerm(Protocol):
    """A physical contribution whose stencils come and go, such as contact."""

    @property
    def velocity_dependent(self) -> bool:
        """Whether a residual depends on velocity."""

    @property
    def symmetric(self) -> bool:
        """Whether the tangents are symmetric, whatever the stencils."""

    @property
    def spreads(self) -> bool:
        """Whether stencils couple DOFs of different nodes, so that entries may come anywhere."""

    def start(self, driver: Driver) -> ChangingSet:
        """Bound terms without stencils yet."""

    def exactly(self) -> ChangingTerm:
        """The same with tangents that are the slopes of its forces, whatever Newton's method is given."""

    def untold(self, left: Iterable[Memory]) -> str:
        """Why states and velocities do not tell what it does; empty if they do.

        Args:
            left: What the steps of a run left.
        """


class Term(Protocol):
    """A physical contribution, before it is bound to a matrix."""

    @property
    def name(self) -> str:
        """Unique name."""

    @property
    def velocity_dependent(self) -> bool:
        """Whether the residual depends on velocity."""

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """DOF cliques of the tangent; empty for loads that add to the residual only."""

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the matrix positions up once and choose the compiled or the NumPy text."""
