"""Arrays as viewers such as ParaView see them: units in their names, and the body behind every cell."""

from __future__ import annotations

import re

import numpy as np

from ..arrays import FloatArray, IntArray
from .frame import FieldSpec, Topology

DISPLACEMENT = FieldSpec(
    name="displacement",
    unit="m",
    long_name="displacement from the rest position",
    location="node",
    components=3,
)
BODY = FieldSpec(name="body", unit="1", long_name="number of the body in the scenario", location="cell")
RADIUS = FieldSpec(
    name="radius", unit="m", long_name="drawing radius of rod edges, zero on triangles", location="cell"
)
THICKNESS = FieldSpec(
    name="thickness", unit="m", long_name="thickness of triangles, zero on rod edges", location="cell"
)

_FACTOR = re.compile(r"([^\s^]+)(?:\^(\d+))?")


def array_name(field: FieldSpec) -> str:
    """The name with the unit in brackets, such as ``velocity [m s^-1]``.

    HDF5 would take the stroke of ``m/s`` for a folder, so what stands below it has negative exponents.
    """
    above, _, below = field.unit.partition("/")
    factors = [above] if above != "1" else []
    factors += [f"{unit}^-{power or 1}" for unit, power in _FACTOR.findall(below)]
    return f"{field.name} [{' '.join(factors)}]" if factors else field.name


def mesh_arrays(topology: Topology) -> tuple[tuple[FieldSpec, IntArray | FloatArray], ...]:
    """Body, radius and thickness of the cells, edges before triangles; shape (E + T,) each."""
    no_edges, no_triangles = np.zeros(len(topology.edges)), np.zeros(len(topology.triangles))
    return (
        (BODY, np.concatenate((topology.edge_body, topology.triangle_body))),
        (RADIUS, np.concatenate((topology.edge_radius, no_triangles))),
        (THICKNESS, np.concatenate((no_edges, topology.triangle_thickness))),
    )
