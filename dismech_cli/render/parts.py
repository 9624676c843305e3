"""What moves in a picture, as triangles; every renderer draws the same parts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

from ..arrays import FloatArray, IntArray
from ..output.read import Run
from .balls import make_balls
from .chains import find_chains
from .settings import Rgb
from .shell_solid import make_shells
from .tubes import make_tubes

# What runs with contact have a column of; rods touch as lines with a thickness, so that their ends are round.
_TOUCH: Final = "contact"
# Ends of chains at a node that has a ball.
_ROUND: Final = 1
_JUNCTION: Final = 2


class Part(Protocol):
    """A closed surface that follows the nodes."""

    @property
    def faces(self) -> IntArray:
        """Triangles, counter-clockwise from outside, shape (F, 3)."""

    @property
    def source(self) -> IntArray:
        """Node behind each vertex, whose colour it has, shape (V,)."""

    @property
    def body(self) -> IntArray:
        """Body of each vertex, shape (V,)."""

    @property
    def color(self) -> Rgb | None:
        """Colour of the whole, or None for that of the bodies or of the field."""

    @property
    def meshed(self) -> bool:
        """Whether its triangles are those of the model, and may have lines."""

    def place(self, t: float, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Vertices [m] and outward unit normals at a time [s], shape (V, 3) each.

        What is not there at this time has its vertices in one point.
        """


Maker = Callable[[Run, float], list[Part]]
"""Makes parts of a run; lengths below the second argument [m] would vanish between the pixels."""


def make_bodies(run: Run, least: float, sides: int) -> list[Part]:
    """The rods and shells of a run, and balls where rods meet; where bodies touch, on all their ends.

    Args:
        run: The run.
        least: Least radius [m] that is drawn.
        sides: Of a tube.
    """
    topology = run.topology
    chains = find_chains(topology.edges, topology.edge_radius, topology.edge_body)
    parts: list[Part] = []
    if chains:
        parts.append(make_tubes(chains, topology.rest_positions, least, sides))
    parts += make_balls(chains, least, sides, _ROUND if _TOUCH in topology.scalars else _JUNCTION)
    parts += make_shells(topology, least / 2)
    return parts


EXTRAS: tuple[Maker, ...] = ()
"""What is drawn beside the bodies, such as marks of joints or contacts: one file with a maker each."""


def make_parts(run: Run, least: float, sides: int) -> list[Part]:
    """All parts of the pictures of a run."""
    return [*make_bodies(run, least, sides), *(part for make in EXTRAS for part in make(run, least))]
