"""What is left of a table, marker by marker or probe by probe."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...arrays import BoolArray, FloatArray
from ...frozen import frozen
from .data import Curves, count_of

_SUM: Final = "all together"


@frozen
class Part:
    """How far off a marker is, or what a probe reads.

    Attributes:
        name: Number of the marker or name of the probe; or all probes of a row together.
        mean: Mean distance, or size of the difference, where it is fitted; NaN where it is not.
        worst: The largest.
        held: Mean where it is predicted; NaN where it is not.
        worst_held: The largest.
    """

    name: str
    mean: float
    worst: float
    held: float
    worst_held: float


def parted(curves: Curves, off: FloatArray) -> tuple[Part, ...]:
    """The parts of a table, given the sizes of what is left of its samples, shape (R, C)."""
    markers = curves.spec.markers
    if markers is None:
        parts = [_part(name, off[:, k], curves, slice(k, k + 1)) for k, name in enumerate(curves.labels)]
        if len(parts) > 1:
            parts.append(_part(_SUM, off.sum(axis=1), curves, slice(None)))
        return tuple(parts)
    letters = len(markers.columns)
    distances = np.sqrt((off.reshape(len(off), -1, letters) ** 2).sum(axis=2))
    return tuple(
        _part(f"marker {markers.first + k}", distances[:, k], curves, slice(letters * k, letters * (k + 1)))
        for k in range(count_of(markers))
    )


def _part(name: str, off: FloatArray, curves: Curves, columns: slice) -> Part:
    """One of them: a row counts where all its columns are there."""
    fitted, held = curves.fitted[:, columns], curves.held[:, columns]
    return Part(name, *_mean_and_worst(off, fitted), *_mean_and_worst(off, held))


def _mean_and_worst(off: FloatArray, samples: BoolArray) -> tuple[float, float]:
    there = off[np.flatnonzero(samples.all(axis=1))]
    return (float(there.mean()), float(there.max())) if there.size else (float("nan"), float("nan"))
