"""Fields of contact: how hard nodes, edges and triangles are pressed."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...output.frame import FieldSpec
from .snapshot import Snapshot

CONTACT_FORCE = FieldSpec(
    name="contact_force",
    unit="N",
    long_name="force of contact on each node, friction included",
    location="node",
    components=3,
)
CONTACT_LINE_LOAD = FieldSpec(
    name="contact_line_load", unit="N/m", long_name="normal force of contact per rest length", location="cell"
)
CONTACT_PRESSURE = FieldSpec(
    name="contact_pressure", unit="Pa", long_name="normal force of contact per rest area", location="node"
)


@frozen
class ContactForceField:
    """What presses on each node and rubs along it, summed up as vectors."""

    visible: int
    spec: FieldSpec = CONTACT_FORCE

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N, 3)."""
        out = np.zeros((self.visible, 3))
        for touch in s.touching():
            out += touch.forces[: self.visible]
        return out


@frozen
class LineLoadField:
    """Normal force per length of the edges of rods: means of that at their ends.

    Times the lengths it adds up to the whole force, whatever its directions: of what is squeezed from two
    sides both count.

    Attributes:
        edges: Ends, shape (E, 2).
        lengths: That each of the visible nodes stands for [m], shape (N,).
    """

    edges: IntArray
    lengths: FloatArray
    spec: FieldSpec = CONTACT_LINE_LOAD

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E,)."""
        means: FloatArray = _spread(s, self.lengths)[self.edges].mean(axis=1)
        return means


@frozen
class PressureField:
    """Normal force per area at the nodes of shells, whatever its directions.

    Attributes:
        areas: That each of the visible nodes stands for, a third of its triangles [m^2], shape (N,).
    """

    areas: FloatArray
    spec: FieldSpec = CONTACT_PRESSURE

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        return _spread(s, self.areas)


def _spread(s: Snapshot, sizes: FloatArray) -> FloatArray:
    """Loads of the nodes over what these stand for, 0 where that is nothing."""
    loads = sum((touch.loads[: len(sizes)] for touch in s.touching()), np.zeros(len(sizes)))
    return np.asarray(np.divide(loads, sizes, out=np.zeros(len(sizes)), where=sizes > 0.0))
