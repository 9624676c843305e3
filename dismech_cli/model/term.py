"""Protocols of the semi-discrete system M a + r(q, v, t) = 0.

A term is three things: which DOFs it couples, its share of the residual, its tangent blocks. It
is bound once to a sparsity pattern and then only adds numbers into arrays. One sign convention:
the residual share is +dE/dq of an energy and -f of a force.
"""

from __future__ import annotations

from typing import ClassVar, Protocol

from ..arrays import FloatArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from .configuration import Configuration


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
    def couplings(self) -> tuple[Coupling, ...]:
        """DOF cliques of the stencils that are there now."""

    def detect(self, c: Configuration) -> bool:
        """Find the stencils at a trial point; True if their couplings changed."""

    def place(self, pattern: Pattern) -> None:
        """Look the matrix positions of the present couplings up in a pattern that has them."""

    def longest_step(self, start: Configuration, end: Configuration) -> float:
        """Part in (0, 1] of the way from ``start`` to ``end`` on which nothing passes through anything."""


class ChangingTerm(Protocol):
    """A physical contribution whose stencils come and go, such as contact.

    Attributes:
        velocity_dependent: Whether the residual depends on velocity.
    """

    velocity_dependent: ClassVar[bool]

    @property
    def name(self) -> str:
        """Unique name."""

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric, whatever the stencils."""

    @property
    def spreads(self) -> bool:
        """Whether stencils couple DOFs of different nodes, so that entries may come anywhere."""

    def start(self, driver: Driver) -> BoundChanging:
        """A bound term without stencils yet."""


class Term(Protocol):
    """A physical contribution, before it is bound to a matrix.

    Attributes:
        velocity_dependent: Whether the residual depends on velocity.
    """

    velocity_dependent: ClassVar[bool]

    @property
    def name(self) -> str:
        """Unique name."""

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """DOF cliques of the tangent; empty for loads that add to the residual only."""

    def bind(self, pattern: Pattern, driver: Driver) -> BoundTerm:
        """Look the matrix positions up once and choose the compiled or the NumPy text."""
