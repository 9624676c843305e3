"""All families of extremes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

from .cantilever import all_corners, single, single_at_rest, slender_sag
from .cell import Cell
from .control import control
from .large import large
from .slender import collapsing, slender
from .units import units


@dataclass(frozen=True, slots=True)
class Family:
    """Scenes of one kind.

    Attributes:
        what: In words, for the table.
        cells: Makes them.
        gives_up: Which of many give up, in words.
    """

    what: str
    cells: Callable[[], Iterator[Cell]]
    gives_up: str = "see the output of the command"


_ONE = (
    "one of E 1e2 to 1e12 Pa, radius 1e-6 to 1 m, density 1 to 2e4, L/r 10 to 1e5, g 0 to 1e3 m/s^2{} at an "
    "end of "
    "its range, {}"
)
FAMILIES: Final[Mapping[str, Family]] = {
    "single": Family(_ONE.format(", dt 1e-7 to 1 s", "implicit Euler"), partial(single, "implicit_euler")),
    "single_tr_bdf2": Family(_ONE.format(", dt 1e-7 to 1 s", "TR-BDF2"), partial(single, "tr_bdf2")),
    "rest_2d": Family(_ONE.format("", "at rest in the plane"), partial(single_at_rest, 2)),
    "rest_3d": Family(_ONE.format("", "at rest in space"), partial(single_at_rest, 3)),
    "corners": Family(
        "the product of all ends of these ranges, implicit Euler and at rest",
        all_corners,
        "under g = 1e3 m/s^2 at rest, where weight stretches soft rods 2e5 times and more",
    ),
    "sag": Family("E 1e3 to 1e12, L/r 10 to 1e5 at equal rho g A L^3/EI: equal sag", slender_sag),
    "units": Family("a coil and a sheet in mm, um and km, in g, ug and t, at rest and in time", units),
    "slender": Family("rods, plates, pendulums that hardly stretch: EA L^2/EI 1e5 to 1e17", slender),
    "collapsing": Family("ends led past each other, rods that shrink to nothing, plates crushed", collapsing),
    "control": Family(
        "feedback with gains 1e-6 to 1e6 and periods of 0.1 to 100 steps, against the recursion of its "
        "samples; "
        "ideal feedback",
        control,
    ),
    "large": Family("1e5 degrees of freedom, and rods of 500 to 50 000 edges bent at rest", large),
}
