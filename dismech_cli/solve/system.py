"""A model bound to a sparsity pattern: residual, tangent and potential of a stage."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..kernels.linearization import Coupling, all_symmetric
from ..kernels.loop_text import LoopText
from ..kinematics.motion import held_dofs
from ..kinematics.rod_frames import FrameState
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from ..model.term import BoundChanging, BoundEnergy, BoundTerm, Memory
from ..model.touch import Touch
from .assembly import Assembly, Linearized, Terms
from .linear import band_loops
from .linear.banded import BandedSolver
from .linear.choice import LINEAR_SOLVERS, choose_solver
from .linear.factors import LinearSolver
from .overlay import Overlay, convexly, exactly
from .pattern import Outline, Sized, SparsityPattern
from .stage import Stage
from .trials import Trials, at, trial

if TYPE_CHECKING:
    from .woven import Woven

_EPS = float(np.finfo(np.float64).eps)


def base_pattern(model: Model, free: BoolArray) -> SparsityPattern:
    """The pattern of a model's terms that stay.

    Args:
        model: The semi-discrete system.
        free: Mask of the free DOFs, shape (n,).
    """
    couplings, symmetric = _couplings(model)
    return SparsityPattern.build(model.dofs, free, couplings, symmetric=symmetric)


def base_outline(model: Model, free: BoolArray) -> Outline:
    """Sizes of :func:`base_pattern`, for a part of its price."""
    couplings, symmetric = _couplings(model)
    return SparsityPattern.outline(model.dofs, free, couplings, symmetric=symmetric)


def _couplings(model: Model) -> tuple[list[Coupling], bool]:
    """What terms that stay couple, and whether all terms are symmetric."""
    couplings = [coupling for term in model.terms for coupling in term.couplings]
    return couplings, all_symmetric(couplings) and all(term.symmetric for term in model.changing)


def chosen_solver(model: Model, pattern: Sized, wanted: str) -> str:
    """Key of ``LINEAR_SOLVERS`` for a model with this pattern; ``wanted`` may be one, or ``"auto"``."""
    if not pattern.m:
        return "dense"  # which alone takes a matrix without rows
    spreads = any(term.spreads for term in model.changing)
    return choose_solver(pattern, spreads=spreads) if wanted == "auto" else wanted


def step_loops(model: Model, solver: str = "auto") -> tuple[tuple[LoopText, ...], str]:
    """The modules of the compiled step of a model that starts at rest, its own last, or why it has none.

    Args:
        model: The semi-discrete system.
        solver: Key of ``LINEAR_SOLVERS``, or ``"auto"``.
    """
    from .weaving import obstacle, weaving

    free = ~held_dofs(model.motions, model.dofs.n, 0.0)
    if why_not := obstacle(model, int(free.sum())):
        return (), why_not
    pattern = base_pattern(model, free)
    if LINEAR_SOLVERS[chosen_solver(model, pattern, solver)] is not BandedSolver:
        return (), "the matrix is no narrow band"
    nothing = np.zeros(model.dofs.n)
    frames = model.frames.transport(model.frames.rest(model.rest), model.rest)
    found = weaving(model, pattern, Configuration(0.0, model.rest, nothing, frames))
    return (() if found.text is None else (*found.below, found.text)), found.why_not


class System:
    """All terms bound to one pattern, with their assembly and a linear solver.

    Terms that stay are bound once, to the base pattern; those whose stencils come and go have an overlay
    on it. A scene without such terms has none, and one pattern for ever.

    Attributes:
        model: The semi-discrete system.
        pattern: Its free DOFs and the places of the tangent.
        solver: Factorises matrices of this pattern.
        analyses: How often a pattern has been analysed.
        at_node: 1 for free positions and 0 for angles, in matrix order, shape (m,).
        at_angle: The opposite.
        extent: Size of the rest shape [m].
    """

    def __init__(self, model: Model, free: BoolArray, solver: str = "auto") -> None:
        """Bind a model.

        Args:
            model: The semi-discrete system.
            free: Mask of the free DOFs, shape (n,).
            solver: Key of ``LINEAR_SOLVERS``, or ``"auto"``.
        """
        self.model = model
        base = base_pattern(model, free)
        self._base = self.pattern = base
        self._exact = Terms.bound(model, base, model.driver, exactly)
        self._overlay = Overlay(base, model.changing, model.driver) if model.changing else None
        self._assembly, self._trials = Assembly(model, base), Trials(model)
        self._energies = [energy for term in self.terms if (energy := term.potential) is not None]
        self._others = [term for term in self.terms if term.potential is None]
        self._split = model.dofs.n_positions
        at_node = base.free < self._split
        self.at_node = at_node.astype(np.float64)
        self.at_angle = 1.0 - self.at_node
        self.extent = float(np.ptp(model.dofs.positions(model.rest), axis=0).max())
        self._make_solver = LINEAR_SOLVERS[chosen_solver(model, base, solver)]
        self.analyses = 0
        self._looked = False
        self._woven: Woven | None = None
        self.solver: LinearSolver = self._analysed(base)

    def woven(self, at: Callable[[], Configuration]) -> Woven | None:
        """The compiled steps, where the model has them; ``at`` is asked once for a point to look at."""
        if not self._looked:
            self._looked = True
            banded, driver = self._make_solver is BandedSolver, self.model.driver
            if banded and driver.compiled(band_loops.pivoted) is not None:
                from .woven import weave

                self._woven = weave(self.model, self.pattern, at())
        return self._woven

    @property
    def terms(self) -> tuple[BoundTerm, ...]:
        """Every bound term."""
        return (*self._exact.symmetric, *self._exact.general, *self.changing)

    @property
    def changing(self) -> tuple[BoundChanging, ...]:
        """Those whose stencils come and go."""
        return () if self._overlay is None else self._overlay.terms

    @property
    def rubs(self) -> bool:
        """Whether any of these depends on velocity."""
        return self._overlay is not None and self._overlay.rubs

    @property
    def changing_seconds(self) -> float:
        """Wall time that what comes and goes took so far [s]."""
        return 0.0 if self._overlay is None else self._overlay.watch.seconds

    @property
    def energies(self) -> list[BoundEnergy]:
        """The bound terms whose residual is the gradient of an energy."""
        return self._energies

    @cached_property
    def _projected(self) -> Terms:
        """The terms with projected tangents; bound when first needed, which is seldom."""
        from ..kernels.projection import ProjectedDriver

        return Terms.bound(self.model, self._base, ProjectedDriver(self.model.driver), convexly)

    def _analysed(self, pattern: SparsityPattern) -> LinearSolver:
        """Take a pattern for that of the matrix; make its solver."""
        self.pattern = pattern
        self._position_slots = pattern.diagonal[self.at_node == 1.0]
        self.analyses += 1
        return self._make_solver(pattern)

    def recall(self, state: State) -> None:
        """Take up what the step to a state left, and forget what came and went in it."""
        if self._overlay is not None:
            self._overlay.recall(state.memory)

    def begin_step(self, start: State, dt: float) -> None:
        """Make ready for a step of ``dt`` [s] from a state that was recalled."""
        if self._overlay is not None:
            self._overlay.begin(self.at(start), dt)

    def settle(self, end: State) -> bool:
        """Whether a step that ended here may stand; if not, what comes and goes will act otherwise."""
        return self._overlay is None or self._overlay.settle(self.at(end))

    def take_back(self) -> None:
        """Undo what the last :meth:`settle` changed."""
        assert self._overlay is not None
        self._overlay.take_back()

    def left(self, start: State) -> tuple[Memory, float]:
        """What a step from ``start`` leaves to the next, and the energy that its changes put in [J]."""
        if self._overlay is None:
            return start.memory, 0.0
        return self._overlay.memory(), self._overlay.put_in(self.at(start))

    def touch(self, state: State) -> tuple[Touch, ...]:
        """What touches at a state."""
        c = self.at(state)
        return () if self._overlay is None else tuple(one.touch(c) for one in self._overlay.sets)

    def at(self, state: State) -> Configuration:
        """A state as a trial point."""
        return at(self.model, state) if self._overlay is None else self._trials.at(state)

    def configuration(self, stage: Stage, q: FloatArray, stored: FrameState) -> Configuration:
        """Evaluate the trial point of a stage."""
        if self._overlay is None:
            return trial(self.model, stage, q, stored)
        return self._trials.trial(stage, q, stored)

    def linearize(self, stage: Stage, q: FloatArray, stored: FrameState) -> Linearized:
        """Residual and tangent of a stage, with the sizes that say when the residual is small."""
        return self._assemble(self._exact, stage, q, stored)

    def linearize_projected(self, stage: Stage, q: FloatArray, stored: FrameState) -> Linearized:
        """The same with the tangents of energies made positive semi-definite stencil by stencil."""
        return self._assemble(self._projected, stage, q, stored)

    def _assemble(self, terms: Terms, stage: Stage, q: FloatArray, stored: FrameState) -> Linearized:
        c = self.configuration(stage, q, stored)
        if self._overlay is not None:
            self._overlay.detect(c)
            if self._overlay.follow():
                self.solver = self._analysed(self._overlay.pattern)
        return self._assembly.add_up(terms, self._overlay, c, stage, q)

    def potential(self, stage: Stage, q: FloatArray, stored: FrameState) -> tuple[float, FloatArray]:
        """Energy [J] of all potential terms at the stage, and the rest of the residual (n,).

        Divided by the stage's position weight the energy is the potential part of the stage's
        merit function; the rest (inertia, drag) is integrated along a search direction.
        """
        c = self.configuration(stage, q, stored)
        if self._overlay is not None:
            self._overlay.detect(c)
        rest = self.model.mass * stage.acceleration(q)
        for term in self._others:
            term.add_residual(c, rest)
        return sum(float(term.energy(c).sum()) for term in self._energies), rest

    def longest_step(self, stage: Stage, q: FloatArray, end: FloatArray, stored: FrameState) -> float:
        """Part in (0, 1] of the way from ``q`` to ``end`` on which nothing passes through anything."""
        if self._overlay is None:
            return 1.0
        return self._overlay.longest_step(
            self.configuration(stage, q, stored), self.configuration(stage, end, stored)
        )

    def reverses(self, stage: Stage, q: FloatArray, end: FloatArray, stored: FrameState) -> bool:
        """Whether friction turns round on the way from ``q`` to ``end``."""
        return self._overlay is not None and self._overlay.reverses(
            self.configuration(stage, q, stored), self.configuration(stage, end, stored)
        )

    def residual(self, stage: Stage, q: FloatArray, stored: FrameState) -> FloatArray:
        """M a + r alone, shape (n,)."""
        c = self.configuration(stage, q, stored)
        r: FloatArray = self.model.mass * stage.acceleration(q)
        for term in self.terms:
            term.add_residual(c, r)
        return r

    def round_off(self, values: FloatArray, q: FloatArray) -> float:
        """Norm of the residual that rounding of positions alone explains [N]."""
        positions = q[: self._split]
        size = max(float(positions.max(initial=0.0)), -float(positions.min(initial=0.0)))
        stiffest = float(values[self._position_slots].max(initial=0.0))
        return 2.0 * _EPS * stiffest * size * sqrt(len(self._position_slots))
