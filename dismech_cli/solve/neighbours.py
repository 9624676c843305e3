"""A parameter as models at neighbouring values of it, and what of a balance changes from one to the next.

Whatever a parameter means to a scene (a modulus, a radius, a natural curvature, a load, a value of a table
of time, the length of a rod), composing the scene at other values gives models whose terms, masses, motions
and starts differ. Their central difference, of the balance at a fixed state and never of the run, is the
derivative: rounding and curvature leave about 1e-11 of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Final, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kinematics.motion import Since, prescribe
from ..model.alike import alike
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.state import State
from ..model.term import BoundTerm
from .anew import Anew
from .pattern import SparsityPattern

_EPS = float(np.finfo(np.float64).eps)


@frozen
class Difference:
    """A difference quotient of fourth order.

    Attributes:
        offsets: Places of the values, in steps.
        weights: Of the values, to be divided by the step.
    """

    offsets: tuple[int, ...]
    weights: tuple[float, ...]

    def __call__(self, values: Sequence[FloatArray], step: float) -> FloatArray:
        """The derivative from values at the places."""
        terms = [w * x for w, x in zip(self.weights, values, strict=True)]
        total: FloatArray = sum(terms[1:], terms[0]) / step
        return total


CENTRAL: Final = Difference((1, -1, 2, -2), (8.0 / 12.0, -8.0 / 12.0, -1.0 / 12.0, 1.0 / 12.0))
AHEAD: Final = Difference((0, 1, 2, 3, 4), (-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25))
BEHIND: Final = Difference((0, -1, -2, -3, -4), (25.0 / 12.0, -4.0, 3.0, -4.0 / 3.0, 0.25))
DIFFERENCES: Final = (CENTRAL, BEHIND, AHEAD)
"""In the order in which they are tried: at a bound of a parameter, such as a Poisson's ratio of 0.5, there
are values on one side alone."""


Span: TypeAlias = tuple[float, float]
"""Two times, both included [s]."""

ALWAYS: Final[Span] = (-np.inf, np.inf)


class UnlikeError(Exception):
    """Models at neighbouring values of a parameter are not of one structure."""

    def __init__(self, index: int) -> None:
        super().__init__(f"parameter {index}")
        self.index = index


@frozen
class Neighbours:
    """Models of one scene at neighbouring values of a parameter.

    Attributes:
        step: Distance of the values.
        difference: Says where they are.
        models: One for each of its places.
        starts: Where runs of them start.
        span: When the balance depends on the parameter; what else the models differ by is not its doing.
    """

    step: float
    difference: Difference
    models: tuple[Model, ...]
    starts: tuple[State, ...]
    span: Span = ALWAYS

    def counts(self, t: float) -> bool:
        """Whether the balance depends on the parameter at a time [s]."""
        since, until = self.span
        return since <= t <= until

    def slope(self, values: Sequence[FloatArray]) -> FloatArray:
        """Derivative of what has these values at the neighbours."""
        return self.difference(values, self.step)

    def affine_slope(self, ahead: FloatArray, here: FloatArray) -> FloatArray:
        """The same of what is affine in the parameter, from its values at the first neighbour and here."""
        slope: FloatArray = (ahead - here) / (self.difference.offsets[0] * self.step)
        return slope


@frozen
class Variation:
    """Derivative of a state to P parameters.

    Attributes:
        q: Shape (n, P).
        v: Its rate, shape (n, P).
        a: The rate of that, shape (n, P).
        turns: By how much carried frames turn beyond that, for each kind of edges (E, P).
        residual: Derivative of M a + r of the last stage, shape (n, P).
        inputs: What controllers put in, shape (I, P).
        memory: What they remember, by name, the parameters last.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    turns: tuple[FloatArray, ...]
    residual: FloatArray
    inputs: FloatArray
    memory: Mapping[str, FloatArray] = field(default_factory=dict)

    def moved(self, state: State, column: int, step: float) -> State:
        """A state by a step on in the direction of one parameter; its frames stay where they are stored."""
        return replace(
            state,
            q=state.q + step * self.q[:, column],
            v=state.v + step * self.v[:, column],
            a=state.a + step * self.a[:, column],
            inputs=state.inputs + step * self.inputs[:, column],
            memory={
                name: values + step * self.memory[name][..., column] if name in self.memory else values
                for name, values in state.memory.items()
            },
        )


class ParameterSlope:
    """Derivatives of the parts of a model to one parameter.

    Attributes:
        mass: That of the diagonal of the mass matrix, shape (n,).
        inert: Whether that is zero.
        shares: Slope of the residual of each term, of the residual itself where it is a multiple of it and
            zero elsewhere, shape (T,).
        moves: Whether motions change with the parameter.
        nothing: Whether the parameter changes nothing at all.
    """

    def __init__(
        self,
        index: int,
        model: Model,
        near: Neighbours,
        pattern: SparsityPattern,
        terms: Sequence[BoundTerm],
    ) -> None:
        """Find what changes.

        Args:
            index: Which parameter it is.
            model: The model at the value itself.
            near: Its neighbours.
            pattern: Holds all DOFs; terms want one when they are bound.
            terms: Those of the model, bound to it.

        Raises:
            UnlikeError: A neighbour has another structure.
        """
        names = [term.name for term in model.terms]
        for other in near.models:
            if (
                other.dofs != model.dofs
                or [term.name for term in other.terms] != names
                or len(other.changing) != len(model.changing)
            ):
                raise UnlikeError(index)
        self._near = near
        changed = [
            index
            for index, term in enumerate(model.terms)
            if not all(alike(term, other.terms[index]) for other in near.models)
        ]
        self._terms = [
            _Varied(
                near, index, tuple(other.terms[index].bind(pattern, other.driver) for other in near.models)
            )
            for index in changed
        ]
        points = [Here(c, terms) for c in _anywhere(model, near.starts[0])]
        for term in self._terms:
            term.look(points)
        self.shares = np.zeros(len(model.terms))
        for term in self._terms:
            self.shares[term.index] = term.share
        self._rest = [term for term in self._terms if not term.share]
        self.mass = near.slope([other.mass for other in near.models])
        self.inert = not self.mass.any()
        starts = [(one.q, one.v, one.a, one.frames) for one in near.starts]
        self.moves = not all(alike(model.motions, other.motions) for other in near.models)
        touching = not all(alike(model.changing, other.changing) for other in near.models)
        self._touching = [Anew(other.changing, other.driver) for other in near.models if touching]
        self.nothing = (
            not changed
            and not touching
            and self.inert
            and not self.moves
            and all(alike(starts[0], x) for x in starts)
        )

    @property
    def others(self) -> bool:
        """Whether there is anything that has no share."""
        return bool(self._rest or self._touching)

    def of_others(self, here: Here) -> FloatArray | None:
        """Dr/dp at a fixed state of what has no share, shape (n,); None where there is nothing."""
        if not self._near.counts(here.c.t):
            return None
        parts = [term.slope(here) for term in self._rest]
        if self._touching:
            parts.append(self._near.slope([one.residual(here.c) for one in self._touching]))
        return sum(parts[1:], parts[0]) if parts else None

    def of_holds(
        self, held: IntArray, t: float, since: Since, dq: FloatArray, turns: Sequence[FloatArray]
    ) -> FloatArray:
        """Derivative of where held DOFs are at ``t`` [s], where the parameter moves them, shape (K,).

        Args:
            held: The DOFs.
            t: End of the stage.
            since: State that it started from.
            dq: Derivative of that, shape (n,).
            turns: That of its frames, shape (E,) for each kind of edges.
        """
        values = []
        for offset, model in zip(self._near.difference.offsets, self._near.models, strict=True):
            step = offset * self._near.step
            q = since.q + step * dq
            frames = model.frames.turned(since.frames, q, [step * turn for turn in turns])
            start = Since(since.t, q, frames)
            end = q.copy()
            prescribe(model.motions, end, t, start)
            values.append(end[held])
        return self._near.slope(values)

    def of_start(self, start: State) -> tuple[FloatArray, FloatArray, FloatArray, tuple[FloatArray, ...]]:
        """Derivatives of positions, rates, second rates (n,) and turns of frames (E,) at the start."""
        near = self._near
        q = near.slope([other.q for other in near.starts])
        v = near.slope([other.v for other in near.starts])
        a = near.slope([other.a for other in near.starts])
        turned = [
            model.frames.turns(model.frames.transport(start.frames, other.q).state, other.frames)
            for model, other in zip(near.models, near.starts, strict=True)
        ]
        return q, v, a, tuple(near.slope(angles) for angles in zip(*turned, strict=True))


class Here:
    """Residuals of the terms of a model at a trial point, each found once for all parameters."""

    def __init__(self, c: Configuration, terms: Sequence[BoundTerm]) -> None:
        self.c = c
        self._terms = terms
        self._found: dict[int, FloatArray] = {}

    def residual(self, index: int) -> FloatArray:
        """That of one term, shape (n,)."""
        if index not in self._found:
            self._found[index] = residual_of(self._terms[index], self.c)
        return self._found[index]


def residual_of(term: BoundTerm, c: Configuration) -> FloatArray:
    """That of one term at a trial point, shape (n,)."""
    r = np.zeros_like(c.q)
    term.add_residual(c, r)
    return r


class _Varied:
    """A term at the neighbours.

    What is a multiple of the residual itself, as by a modulus, needs no evaluation; what is affine, as by a
    load, needs one; the rest needs as many as there are neighbours.
    """

    def __init__(self, near: Neighbours, index: int, terms: tuple[BoundTerm, ...]) -> None:
        self._near, self.index, self._terms = near, index, terms
        self._affine = False
        self.share = 0.0

    def look(self, points: Sequence[Here]) -> None:
        """Which it is, seen at some trial points."""
        step, affine, seen = self._near.step, True, False
        shares, multiple = [], True
        for here in points:
            residual = here.residual(self.index)
            values = [residual_of(term, here.c) for term in self._terms]
            rough, fine = self._near.affine_slope(values[0], residual), self._near.slope(values)
            slope = _largest(fine)
            # what rounding of the values alone may leave
            rounding = 64.0 * _EPS * max(map(_largest, values)) / step
            affine &= _largest(rough - fine) <= rounding + 1e-13 * slope
            # what matters at other times only, as a knot of a table does, is not known to be affine
            seen |= slope > rounding
            size = float(residual @ residual)
            share = float(fine @ residual) / size if size > 0.0 else 0.0
            multiple &= _largest(fine - share * residual) <= rounding + 1e-13 * slope
            shares.append(share)
        # on one side alone a wrong guess would cost three orders of accuracy
        self._affine = affine and seen and self._near.difference is CENTRAL
        # the same multiple everywhere, and at all times: a load may be one up to the first knot of its table
        steady = all((energy := term.potential) is not None and energy.steady for term in self._terms)
        mean = float(np.mean(shares))
        if steady and seen and multiple and np.ptp(shares) <= 1e-9 * abs(mean):
            self.share = mean

    def slope(self, here: Here) -> FloatArray:
        """Derivative of its residual, shape (n,)."""
        if self._affine:
            return self._near.affine_slope(residual_of(self._terms[0], here.c), here.residual(self.index))
        return self._near.slope([residual_of(term, here.c) for term in self._terms])


def _largest(x: FloatArray) -> float:
    return float(np.abs(x).max(initial=0.0))


def _anywhere(model: Model, start: State) -> list[Configuration]:
    """Trial points as good as any: shapes and speeds by chance near a start, at several times."""
    rng = np.random.default_rng(7)
    points = []
    for t in (0.0, 0.137, 1.0, 3.71):
        q = start.q + 0.1 * model.length * rng.uniform(-1.0, 1.0, len(start.q))
        v = model.length * rng.uniform(-1.0, 1.0, len(start.q))
        frames = model.frames.transport(start.frames, q)
        points.append(Configuration(t, q, v, frames, start.inputs))
    return points
