"""Nodes that lie together made one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, distinct
from ...errors import MeshError
from ..limits import MAX_COORDINATE
from ..mesh import Mesh
from .components import components

_MOST_NEAR = 32
"""Pairs per node, on average, that welding looks at; more mean a length beyond that of the edges."""


def weld_nodes(mesh: Mesh, within: float, where: str) -> tuple[Mesh, BoolArray]:
    """Let elements and groups name the first of nodes that lie together.

    Args:
        mesh: With node numbers in range.
        within: Distance up to which nodes become one, from node to node [length unit of the mesh].
        where: Names the mesh in messages.

    Returns:
        The mesh, whose nodes stay, and which of them nothing names any more, shape (N,).

    Raises:
        MeshError: If so many nodes lie within the distance that it cannot be meant.
    """
    first = _first_of_each(mesh.nodes, within, where)
    gone = first != np.arange(len(first))
    if not gone.any():
        return mesh, gone
    count = int(gone.sum())
    note = (
        f"{count} {'node' if count == 1 else 'nodes'} welded to others within {within:g} (units of the file)."
    )
    welded = replace(
        mesh,
        edges=first[mesh.edges],
        triangles=first[mesh.triangles],
        node_groups={name: distinct(first[group]) for name, group in mesh.node_groups.items()},
        notes=(*mesh.notes, note),
    )
    return welded, gone


def _first_of_each(nodes: FloatArray, within: float, where: str) -> IntArray:
    """The lowest number among the nodes that lie together with each, shape (N,)."""
    from scipy.spatial import cKDTree

    first = np.arange(len(nodes))
    # What is not finite is told later; many equal points would make as many pairs as their square.
    sound = np.flatnonzero((np.abs(nodes) <= MAX_COORDINATE).all(axis=1))
    places, lowest, place = np.unique(nodes[sound], axis=0, return_index=True, return_inverse=True)
    if not len(places):
        return first
    tree = cKDTree(places)
    if tree.count_neighbors(tree, within) > (1 + 2 * _MOST_NEAR) * len(places):
        raise MeshError(
            f"{where}: more than {_MOST_NEAR} nodes lie within the weld of {within:g} (units of the file) "
            "of each other; expected a length well below that of the edges"
        )
    pieces, label = components(len(places), tree.query_pairs(within, output_type="ndarray"))
    leader = np.full(pieces, len(nodes))
    np.minimum.at(leader, label, sound[lowest])
    first[sound] = leader[label[place.ravel()]]
    return first
