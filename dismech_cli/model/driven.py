"""Energies whose natural strain follows a signal: actuation.

The natural strain is a function of the time at which balance is enforced, not a value held over
the step: so actuated runs keep the order of their integrator, and nothing accumulates.
"""

from __future__ import annotations

from collections import deque
from dataclasses import field
from typing import ClassVar, Final, TypeAlias

from ..arrays import BoolArray, FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling, Linearization, Pattern
from ..laws.signal import Signal
from .configuration import Configuration
from .stencil import BoundStencil, StencilEnergy

# A stage within a step, and its ends.
_REMEMBERED: Final = 3
# Numbers kept for times of many steps, which are asked for ahead: 4 MB.
_NUMBERS: Final = 2**19


@frozen
class Drive:
    """An increment of natural strain.

    Attributes:
        row: Which natural strain of the kernel.
        stencils: Driven stencils, shape (K,).
        signal: Strain density over time t and place s.
        places: s of each stencil in [0, 1], shape (K,).
        factors: What turns the signal's value into the kernel's strain: a Voronoi length [m] for
            curvature and twist, 1 for stretch, shape (K,).
    """

    row: int
    stencils: IntArray
    signal: Signal
    places: FloatArray
    factors: FloatArray


Known: TypeAlias = dict[float, tuple[FloatArray, FloatArray]]
"""Inputs, and natural strains under them, by time."""


@frozen
class DrivenEnergy:
    """A stencil energy with drives; remembers the natural strains at the times and inputs last asked."""

    energy: StencilEnergy
    drives: tuple[Drive, ...]
    _known: Known = field(default_factory=dict, init=False, repr=False, compare=False)
    velocity_dependent: ClassVar[bool] = False

    @property
    def name(self) -> str:
        """Name of the energy."""
        return self.energy.name

    @property
    def shares(self) -> tuple[str, ...]:
        """Those of the energy."""
        return self.energy.shares

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Those of the energy."""
        return self.energy.couplings

    @property
    def steady(self) -> bool:
        """Whether no natural strain ever changes."""
        return all(drive.signal.constant for drive in self.drives)

    def natural_at(self, t: float, inputs: FloatArray) -> FloatArray:
        """Natural strains at time ``t``, shape (naturals, S); not to be written to."""
        by, natural = self._known.get(t, (None, inputs))
        # inputs are frozen: other values are another array
        if by is inputs:
            return natural
        natural = self.energy.natural.copy()
        for drive in self.drives:
            natural[drive.row, drive.stencils] += drive.factors * drive.signal.value(t, inputs, drive.places)
        if len(self._known) * natural.size >= _NUMBERS:
            self._known.clear()
        self._known[t] = inputs, natural
        return natural

    def touching(self, dofs: BoolArray) -> DrivenEnergy | None:
        """All of it if any stencil holds any of some DOFs, given as a mask (n,): drives act together."""
        return self if dofs[self.energy.dofs].any() else None

    def bind(self, pattern: Pattern, driver: Driver) -> BoundDriven:
        """Bind the energy."""
        return BoundDriven(self, self.energy.bind(pattern, driver))


class BoundDriven:
    """A driven energy bound to a pattern; remembers the natural strains at the times and inputs last asked.

    Newton's method asks for those of a stage again and again, the energy account for both ends of a step.
    """

    def __init__(self, term: DrivenEnergy, stencil: BoundStencil) -> None:
        self.name = term.name
        self.shares = term.shares
        self.steady = term.steady
        self._term = term
        self._stencil = stencil
        self._known: deque[tuple[float, FloatArray, BoundStencil]] = deque(maxlen=_REMEMBERED)

    def at(self, c: Configuration) -> BoundStencil:
        """The energy with its natural strain at the time and the inputs of ``c``."""
        for t, inputs, stencil in self._known:
            # inputs are frozen: other values are another array
            if t == c.t and inputs is c.inputs:
                return stencil
        stencil = self._stencil.actuated(self._term.natural_at(c.t, c.inputs))
        self._known.appendleft((c.t, c.inputs, stencil))
        return stencil

    @property
    def potential(self) -> BoundDriven:
        """Itself."""
        return self

    def energy(self, c: Configuration) -> FloatArray:
        """Energies [J], shape (shares, S)."""
        return self.at(c).energy(c)

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add dE/dq."""
        self.at(c).add_residual(c, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add dE/dq and d2E/dq2."""
        self.at(c).add_linearization(c, into)
