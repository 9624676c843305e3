"""How far two quantities are apart: the greatest difference over all frames and places, where and when."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...output.frame import FieldSpec, Topology
from ...output.frame_array import FrameArray
from .tolerances import Tolerance


@frozen(kw_only=True)
class Measured:
    """A difference before it is judged.

    Attributes:
        name: Of the quantity.
        unit: SI unit.
        greatest: Greatest difference over all frames and places; of vectors, its length.
        rms: Root of the mean square over the same.
        scale: What relative tolerances refer to: the size of the quantity in the first run.
        t: When it is greatest [s].
        place: Where, in words; empty for a scalar and where there is no difference.
    """

    name: str
    unit: str
    greatest: float
    rms: float
    scale: float
    t: float
    place: str = ""


@frozen
class Difference:
    """A difference and what is allowed.

    Attributes:
        found: The difference.
        tolerance: Greatest one allowed.
    """

    found: Measured
    tolerance: Tolerance

    @property
    def relative(self) -> float:
        """Greatest difference over the scale."""
        if self.found.scale > 0.0:
            return self.found.greatest / self.found.scale
        return 0.0 if self.found.greatest == 0.0 else float("inf")

    @property
    def within(self) -> bool:
        """Whether the tolerance allows it."""
        return self.tolerance.allows(self.found.greatest, self.found.scale)


@frozen(kw_only=True)
class Quantity:
    """What an array over frames is.

    Attributes:
        name: Its name.
        unit: SI unit.
        place: Says where an entry is.
        scale: Its size; None takes the largest entry of the first run.
    """

    name: str
    unit: str
    place: Callable[[int], str]
    scale: float | None = None


def of_frames(
    quantity: Quantity, mine: FrameArray, theirs: FrameArray, times: FloatArray, pairs: IntArray
) -> Measured:
    """The difference of an array over frames, one frame after another.

    Args:
        quantity: What it is.
        mine: Of the first run.
        theirs: Of the second.
        times: Of the frames of the first [s], shape (F,).
        pairs: Frames at one time, shape (P, 2).
    """
    greatest, frame, entry, largest, squares, count = 0.0, int(pairs[0, 0]), 0, 0.0, 0.0, 0
    for k, other in pairs:
        one, two = mine[int(k)], theirs[int(other)]
        distances = apart(one, two)
        if not len(distances):
            continue
        largest = max(largest, size(one))
        most = int(np.argmax(distances))
        squares, count = squares + float(np.sum(distances**2)), count + len(distances)
        if distances[most] > greatest:
            greatest, frame, entry = float(distances[most]), int(k), most
    return Measured(
        name=quantity.name,
        unit=quantity.unit,
        greatest=greatest,
        rms=float(np.sqrt(squares / count)) if count else 0.0,
        scale=largest if quantity.scale is None else quantity.scale,
        t=float(times[frame]),
        place=quantity.place(entry) if greatest > 0.0 else "",
    )


def of_column(
    name: str, unit: str, mine: FloatArray, theirs: FloatArray, times: FloatArray, scale: float
) -> Measured:
    """The difference of a column of the scalar table at common times, each of shape (P,)."""
    distances = apart(mine, theirs)
    most = int(np.argmax(distances))
    return Measured(
        name=name,
        unit=unit,
        greatest=float(distances[most]),
        rms=float(np.sqrt(np.mean(distances**2))),
        scale=scale,
        t=float(times[most]),
    )


def size(values: FloatArray) -> float:
    """Largest entry, of vectors their length; NaN is nothing."""
    return float(np.max(_length(np.nan_to_num(values, nan=0.0)), initial=0.0))


def apart(one: FloatArray, two: FloatArray) -> FloatArray:
    """Difference of each entry, shape (count,); infinite where one of two is no number."""
    both = np.isnan(one) & np.isnan(two)
    with np.errstate(invalid="ignore"):
        distances = _length(np.where(both, 0.0, one - two))
    return np.where(np.isnan(distances), np.inf, distances)


def _length(values: FloatArray) -> FloatArray:
    """Size of each entry, shape (count,): of vectors their length."""
    return np.abs(values) if values.ndim == 1 else np.asarray(np.linalg.norm(values, axis=-1))


def place_of(topology: Topology, spec: FieldSpec, entry: int) -> str:
    """Where an entry of a field is: body, node or cell, and where that is at rest."""
    rods = len(topology.edges)
    if spec.location == "node":
        tables = ((topology.edges, topology.edge_body), (topology.triangles, topology.triangle_body))
        bodies = np.concatenate([body[(cells == entry).any(axis=1)] for cells, body in tables])
        what, corners = f"node {entry}", np.array([entry])
    elif entry < rods:
        bodies = topology.edge_body[[entry]]
        what, corners = f"edge {entry}", topology.edges[entry]
    else:
        bodies = topology.triangle_body[[entry - rods]]
        what, corners = f"triangle {entry - rods}", topology.triangles[entry - rods]
    names = "/".join(topology.bodies[int(body)] for body in np.unique(bodies)) or "mesh"
    where = ", ".join(f"{x:.4g}" for x in topology.rest_positions[corners].mean(axis=0))
    return f"{names}, {what}, at rest ({where}) m"
