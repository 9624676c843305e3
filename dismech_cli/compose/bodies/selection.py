"""Selections of the scenario as node or edge indices; an empty one is an error."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ...arrays import IntArray, distinct
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from ...scenario.values.selection import (
    BoxSelection,
    EdgeSelection,
    GroupSelection,
    IndexSet,
    NearestSelection,
    NodeSelection,
    PlaneSelection,
    Selection,
    Selects,
    SphereSelection,
)
from ...scenario.views.walk import selections
from ...words import hint, listed
from .geometry import Geometry


class SelectionError(ValueError):
    """A selection names what does not exist, or finds the wrong number of things."""


def select_all(
    loaded: LoadedScenario, geometry: Geometry, *wanted: Selects
) -> dict[Selects, dict[KeyPath, IntArray]]:
    """All selections of the scenario that find the wanted things, each resolved once.

    Raises:
        ScenarioError: All of them that name an unknown group or number, or select nothing.
    """
    found: dict[Selects, dict[KeyPath, IntArray]] = {finds: {} for finds in wanted}
    faults: list[tuple[KeyPath, str]] = []
    for one in selections(loaded.scenario):
        if one.finds in found:
            try:
                found[one.finds][one.path] = SELECT[one.finds](geometry, one.where)
            except SelectionError as error:
                faults.append((one.path, str(error)))
    if faults:
        raise loaded.errors(faults)
    return found


def select_nodes(geometry: Geometry, where: Selection) -> IntArray:
    """Node indices of a selection, ascending without repeats.

    Raises:
        SelectionError: It names an unknown group or number, or selects nothing.
    """
    match where:
        case GroupSelection(group=name):
            found = _group(geometry.node_groups, name)
        case NodeSelection(nodes=which):
            found = _numbered(geometry.body_nodes[which.of], which, "node")
        case EdgeSelection(edges=which):
            found = geometry.edges[_numbered(geometry.rod_edges[which.of], which, "edge")]
        case BoxSelection(box=box):
            inside = (geometry.nodes >= box.min) & (geometry.nodes <= box.max)
            found = np.flatnonzero(inside.all(axis=1))
        case PlaneSelection(plane=plane):
            normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
            found = np.flatnonzero(np.abs((geometry.nodes - plane.point) @ normal) <= plane.within)
        case SphereSelection(sphere=sphere):
            found = np.flatnonzero(np.linalg.norm(geometry.nodes - sphere.center, axis=1) <= sphere.radius)
        case NearestSelection(nearest=point):
            found = np.array([np.argmin(np.linalg.norm(geometry.nodes - point, axis=1))])
    if found.size == 0:
        raise SelectionError("selects no node")
    return distinct(found)


def select_edges(geometry: Geometry, where: Selection) -> IntArray:
    """Edge indices of a selection: named edges, or all edges between selected nodes.

    The end of a rod (a single node) means the edge that ends there.

    Raises:
        SelectionError: It names an unknown group or number, or selects no edge.
    """
    match where:
        case GroupSelection(group=name):
            found = _group(geometry.edge_groups, name)
        case EdgeSelection(edges=which):
            found = _numbered(geometry.rod_edges[which.of], which, "edge")
        case _:
            found = edges_among(geometry, select_nodes(geometry, where))
    if found.size == 0:
        raise SelectionError("selects no edge")
    return distinct(found)


def select_single_node(geometry: Geometry, where: Selection) -> IntArray:
    """The one node of a selection, shape (1,).

    Raises:
        SelectionError: It selects none or several.
    """
    found = select_nodes(geometry, where)
    if len(found) != 1:
        raise SelectionError(f"selects {len(found)} nodes; expected one")
    return found


SELECT: Mapping[Selects, Callable[[Geometry, Selection], IntArray]] = {
    Selects.NODES: select_nodes,
    Selects.EDGES: select_edges,
    Selects.JOINED: select_single_node,
    Selects.SEWN: select_nodes,
}


def edges_among(geometry: Geometry, nodes: IntArray) -> IntArray:
    """Edges with both ends selected; for a single node, the edges at it."""
    touched = np.isin(geometry.edges, nodes)
    return np.flatnonzero(touched.any(axis=1) if len(nodes) == 1 else touched.all(axis=1))


def _group(groups: Mapping[str, IntArray], name: str) -> IntArray:
    if name not in groups:
        tail = hint(name, groups) or f"; known: {listed(sorted(groups), 'and')}"
        raise SelectionError(f"no group '{name}'{tail}")
    return groups[name]


def _numbered(members: IntArray, which: IndexSet, what: str) -> IntArray:
    greatest = max(which.indices if which.range is None else which.range)  # type: ignore[arg-type]
    if greatest >= len(members):
        raise SelectionError(
            f"{what} {greatest} of '{which.of}' does not exist; it has {len(members)}, counted from 0"
        )
    found: IntArray = (
        members[np.array(which.indices)]
        if which.range is None
        else members[which.range[0] : which.range[1] + 1]
    )
    return found
