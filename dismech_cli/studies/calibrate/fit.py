"""The end of a fit: values, how far they can be trusted, and how each table of samples is met."""

from __future__ import annotations

from typing import Final

from ...arrays import FloatArray
from ...frozen import frozen
from .data import Curves
from .knobs import Knob
from .parts import Part

# Correlation from which two values are hardly told apart; squares per degree of freedom that are too many.
_ALIKE: Final = 0.99
_POOR: Final = 2.0


@frozen
class Table:
    """How a table of samples is met.

    Attributes:
        curves: The samples.
        deviation: Standard deviation taken for them.
        fit: Root mean square of what is left of the fitted samples.
        worst: The largest.
        held: Root mean square of those kept out; NaN if there are none.
        scale: Size of a metre in them, where they are of a picture; else 1.
        samples: How many are fitted.
        shown: What the fit gives in their places, shape (R, C).
        parts: How each marker or probe of it is met.
    """

    curves: Curves
    deviation: float
    fit: float
    worst: float
    held: float
    scale: float
    samples: int
    shown: FloatArray
    parts: tuple[Part, ...]


@frozen
class Fit:
    """The end of a fit.

    Attributes:
        knobs: What was fitted.
        values: To these values.
        deviations: Standard deviations of the numbers fitted: relative where the logarithm is.
        correlation: Of all of them, shape (P, P).
        condition: Ratio of the strongest to the weakest direction that is seen.
        unseen: Directions of the parameters that the samples do not see, each of shape (P,).
        at_bound: Which stopped at a bound.
        far: Which moved by more than three deviations of what was known.
        chi2: Sum of squares per degree of freedom.
        known: Whether the deviations of all samples are given.
        tables: How each table is met.
        cameras: Of each table that is a picture.
        evaluations: Points at which the scene was evaluated.
        runs: Runs that this took, those of an earlier process not counted.
        message: Why it ended.
        finer: Change of each value at half the time step, in deviations; empty where that was not asked for.
    """

    knobs: tuple[Knob, ...]
    values: FloatArray
    deviations: FloatArray
    correlation: FloatArray
    condition: float
    unseen: tuple[FloatArray, ...]
    at_bound: tuple[bool, ...]
    far: tuple[bool, ...]
    chi2: float
    known: bool
    tables: tuple[Table, ...]
    cameras: tuple[FloatArray | None, ...]
    evaluations: int
    runs: int
    message: str
    finer: FloatArray

    @property
    def doubts(self) -> tuple[str, ...]:
        """Why not to believe the values, a line each."""
        told = []
        for k, knob in enumerate(self.knobs):
            path = knob.setting.path
            if self.at_bound[k]:
                told.append(f"{path} stopped at a bound: what is beyond may fit better")
            if self.far[k]:
                told.append(
                    f"{path} moved by more than 3 deviations of what was known of it: the model may be wrong "
                    "where this value makes up for it"
                )
            if len(self.finer) and abs(self.finer[k]) > 2.0:
                change = f"{self.finer[k]:.2g} deviations at half the time step"
                told.append(f"{path} changes by {change}: take a shorter one")
        for row in self.unseen:
            shown = [
                f"{knob.setting.path} by {part:+.2g}"
                for knob, part in zip(self.knobs, row, strict=True)
                if abs(part) > 0.1
            ]
            told.append(
                f"the samples do not see changes of {', '.join(shown) or 'a camera'}: fix one of them"
            )
        for i, one in enumerate(self.knobs):
            for j in range(i):
                if abs(self.correlation[i, j]) > _ALIKE:
                    told.append(
                        f"{self.knobs[j].setting.path} and {one.setting.path} are hardly told apart: "
                        f"correlation {self.correlation[i, j]:.4f}"
                    )
        if self.known and self.chi2 > _POOR:
            told.append(
                f"what is left is {self.chi2**0.5:.2g} times as large as the deviations of the samples: the "
                "model does not explain them"
            )
        return tuple(told)
