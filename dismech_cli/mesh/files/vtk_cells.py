"""What cells of VTK are: lines and polygons are taken, single points left out, all else refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...errors import MeshError
from ...frozen import frozen
from ..allowed import Allowed
from ..limits import check_count
from ..mesh import Mesh
from .cells import Cells, groups_by_value, mesh_of_cells

VERTEX, LINE, POLYLINE, TRIANGLE, STRIP, POLYGON, PIXEL, QUAD = 1, 3, 4, 5, 6, 7, 8, 9
_POINTS = (0, VERTEX, 2)
_LINES = (LINE, POLYLINE)
_FACES = (TRIANGLE, POLYGON, PIXEL, QUAD)
_SOLIDS = {10: "tetrahedron", 11: "voxel", 12: "hexahedron", 13: "wedge", 14: "pyramid", 42: "polyhedron"}


@frozen(kw_only=True)
class VtkMesh:
    """A mesh as VTK has it.

    Attributes:
        points: Shape (N, 3).
        connectivity: Nodes of all cells, shape (K,).
        ends: Where each cell ends among them, shape (C,).
        types: Kind of each cell, shape (C,).
        values: Whole numbers on the cells by name, shape (C,) each.
        dropped: Names of the data that carry no mechanics here.
    """

    points: FloatArray
    connectivity: IntArray
    ends: IntArray
    types: IntArray
    values: Mapping[str, IntArray]
    dropped: Sequence[str]


def mesh_of_vtk(found: VtkMesh, where: str, allowed: Allowed) -> Mesh:
    """The lines and polygons of a VTK mesh; whole numbers on cells name groups.

    Raises:
        MeshError: Cells are solid or of another kind, do not add up, or make no usable mesh.
    """
    check_count(len(found.points), "nodes", where)
    check_count(len(found.ends), "cells", where)
    if len(found.types) != len(found.ends):
        raise MeshError(f"{where}: {len(found.types)} cell types for {len(found.ends)} cells")
    sizes = np.diff(found.ends, prepend=0)
    if (sizes < 0).any() or (len(found.ends) and found.ends[-1] > len(found.connectivity)):
        raise MeshError(
            f"{where}: the ends of cells do not ascend to the {len(found.connectivity)} nodes of all"
        )
    strange = ~np.isin(found.types, (*_POINTS, *_LINES, *_FACES))
    if strange.any():
        kind = int(found.types[np.argmax(strange)])
        what = _SOLIDS.get(kind, "not first-order points, lines or polygons")
        raise MeshError(
            f"{where}: cell {np.argmax(strange) + 1} is of VTK type {kind}, {what}; rods and shells need "
            "lines and polygons: save the surface alone"
        )
    connectivity = _pixels_unfolded(found, sizes)
    faces, lines = (np.isin(found.types, kinds) for kinds in (_FACES, _LINES))
    dropped = list(found.dropped)
    for name, values in found.values.items():
        if len(values) != len(found.ends) or not groups_by_value(name, values):
            dropped.append(name)
    notes = (f"Data dropped: {', '.join(dict.fromkeys(dropped))}.",) if dropped else ()
    return mesh_of_cells(
        found.points,
        _some(found, connectivity, sizes, faces),
        _some(found, connectivity, sizes, lines),
        notes,
        where,
        allowed,
    )


def _pixels_unfolded(found: VtkMesh, sizes: IntArray) -> IntArray:
    """Nodes of the cells with pixels, which go row by row, going around."""
    pixels = np.flatnonzero((found.types == PIXEL) & (sizes == 4))
    if not len(pixels):
        return found.connectivity
    turned = found.connectivity.copy()
    last = found.ends[pixels] - 1
    turned[last], turned[last - 1] = found.connectivity[last - 1], found.connectivity[last]
    return turned


def _some(found: VtkMesh, connectivity: IntArray, sizes: IntArray, which: BoolArray) -> Cells:
    """Chosen cells, with groups by the numbers on all."""
    inside = np.repeat(which, sizes)
    place = np.cumsum(which) - 1
    groups: dict[str, IntArray] = {}
    for name, values in found.values.items():
        if len(values) != len(which):
            continue
        for title, members in groups_by_value(name, values).items():
            chosen = place[members[which[members]]]
            if chosen.size:
                groups[title] = chosen
    return Cells(nodes=connectivity[: len(inside)][inside], ends=np.cumsum(sizes[which]), groups=groups)
