"""Numbers over time and position: what a fluid does where a body is now."""

from __future__ import annotations

from dataclasses import field
from typing import Final, Protocol

import numpy as np

from ..arrays import FloatArray
from ..errors import LawError
from ..frozen import frozen
from .expression import Compiled, Program, compile_expression
from .laws import Law
from .slope import compile_slope

SPACE: Final = ("x", "y", "z")
_VARIABLES: Final = ("t", *SPACE)


class Field(Protocol):
    """A value over time t [s] and position x [m]."""

    @property
    def uniform(self) -> bool:
        """True if the value is the same everywhere."""

    def value(self, t: float, x: FloatArray) -> FloatArray:
        """Values at positions x (N, 3), shape (N,)."""

    def gradient(self, t: float, x: FloatArray) -> FloatArray:
        """Their slopes to the position, shape (N, 3)."""


@frozen
class Uniform:
    """A law of time, the same everywhere.

    Attributes:
        law: The law.
    """

    law: Law

    @property
    def uniform(self) -> bool:
        """True."""
        return True

    def value(self, t: float, x: FloatArray) -> FloatArray:
        """The value of the law at every place."""
        return np.full(len(x), float(self.law(t)))

    def gradient(self, t: float, x: FloatArray) -> FloatArray:
        """Zero."""
        return np.zeros_like(x)


@frozen
class Spatial:
    """Arithmetic text of t, x, y and z, see :func:`.expression.compile_expression`.

    Attributes:
        text: The text.

    Raises:
        ExpressionError: if the text is not arithmetic, or has no slope.
    """

    text: str
    _compiled: Compiled = field(init=False, repr=False, compare=False)
    _slopes: tuple[Program | None, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_compiled", compile_expression(self.text, _VARIABLES))
        slopes = tuple(compile_slope(self.text, _VARIABLES, by) for by in SPACE)
        object.__setattr__(self, "_slopes", slopes)

    def __reduce__(self) -> tuple[type[Spatial], tuple[str]]:
        """Pickled by its text: closures cannot be."""
        return Spatial, (self.text,)

    @property
    def uniform(self) -> bool:
        """True if no coordinate occurs."""
        return not self._compiled.variables.intersection(SPACE)

    def value(self, t: float, x: FloatArray) -> FloatArray:
        """The values.

        Raises:
            LawError: if one is not finite.
        """
        return self._evaluated(self._compiled.program, t, x)

    def gradient(self, t: float, x: FloatArray) -> FloatArray:
        """The slopes.

        Raises:
            LawError: if one is not finite.
        """
        out = np.zeros_like(x)
        for axis, slope in enumerate(self._slopes):
            if slope is not None:
                out[:, axis] = self._evaluated(slope, t, x)
        return out

    def _evaluated(self, program: Program, t: float, x: FloatArray) -> FloatArray:
        with np.errstate(all="ignore"):
            values = np.broadcast_to(program(dict(zip(_VARIABLES, (t, *x.T), strict=True))), len(x))
        if not np.isfinite(values).all():
            place = ", ".join(f"{c:.3g}" for c in x[int(np.argmin(np.isfinite(values)))])
            raise LawError(
                f"the expression {self.text!r} has no finite value or slope at t = {t:g} s and ({place}) m"
            )
        return np.array(values, dtype=np.float64)
