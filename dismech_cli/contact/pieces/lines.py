"""Lines of bodies: the edges along which contact is summed."""

from __future__ import annotations

from ...arrays import FloatArray, IntArray
from ...frozen import frozen


@frozen
class Lines:
    """Edges with a thickness.

    Attributes:
        nodes: Ends, shape (E, 2).
        lengths: Rest lengths [m], shape (E,).
        radii: Half of the thickness [m], shape (E,).
        weights: Weight of the energy per length: 1 on rods, the width that an edge of a shell stands for [m],
            shape (E,).
        masses: Of both ends together, which all lines of a shell share that meet there [kg], shape (E,).
        loads: Weight per length that must be carried [N/m], shape (E,).
        bodies: Body of each, shape (E,).
        names: Names of the bodies.
    """

    nodes: IntArray
    lengths: FloatArray
    radii: FloatArray
    weights: FloatArray
    masses: FloatArray
    loads: FloatArray
    bodies: IntArray
    names: tuple[str, ...]

    def some(self, kept: IntArray) -> Lines:
        """Those of some indices."""
        return Lines(
            self.nodes[kept],
            self.lengths[kept],
            self.radii[kept],
            self.weights[kept],
            self.masses[kept],
            self.loads[kept],
            self.bodies[kept],
            self.names,
        )
