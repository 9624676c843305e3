"""Selections of the scenario as node or edge indices; an empty one is an error."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import IntArray
from ...scenario.load import LoadedScenario
from ...scenario.values.selection import (
    BoxSelection,
    EdgeSelection,
    GroupSelection,
    IndexSet,
    NearestSelection,
    NodeSelection,
    PlaneSelection,
    Selection,
    SphereSelection,
)
from ...words import hint, listed
from .geometry import Geometry

KeyPath = tuple[str | int, ...]


def select_nodes(loaded: LoadedScenario, geometry: Geometry, where: Selection, path: KeyPath) -> IntArray:
    """Node indices of a selection, ascending without repeats.

    Raises:
        ScenarioError: It names an unknown group or number, or selects nothing.
    """
    match where:
        case GroupSelection(group=name):
            found = _group(loaded, geometry.node_groups, name, path)
        case NodeSelection(nodes=which):
            found = _numbered(loaded, geometry.body_nodes[which.of], which, "node", path)
        case EdgeSelection(edges=which):
            found = geometry.edges[_numbered(loaded, geometry.rod_edges[which.of], which, "edge", path)]
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
        raise loaded.error(path, "selects no node")
    return np.unique(found)


def select_edges(loaded: LoadedScenario, geometry: Geometry, where: Selection, path: KeyPath) -> IntArray:
    """Edge indices of a selection: named edges, or all edges between selected nodes.

    The end of a rod (a single node) means the edge that ends there.

    Raises:
        ScenarioError: It selects no edge.
    """
    match where:
        case GroupSelection(group=name):
            found = _group(loaded, geometry.edge_groups, name, path)
        case EdgeSelection(edges=which):
            found = _numbered(loaded, geometry.rod_edges[which.of], which, "edge", path)
        case _:
            found = edges_among(geometry, select_nodes(loaded, geometry, where, path))
    if found.size == 0:
        raise loaded.error(path, "selects no edge")
    return np.unique(found)


def select_single_node(loaded: LoadedScenario, geometry: Geometry, where: Selection, path: KeyPath) -> int:
    """The one node of a selection.

    Raises:
        ScenarioError: It selects none or several.
    """
    found = select_nodes(loaded, geometry, where, path)
    if len(found) != 1:
        raise loaded.error(path, f"selects {len(found)} nodes; expected one")
    return int(found[0])


def edges_among(geometry: Geometry, nodes: IntArray) -> IntArray:
    """Edges with both ends selected; for a single node, the edges at it."""
    touched = np.isin(geometry.edges, nodes)
    return np.flatnonzero(touched.any(axis=1) if len(nodes) == 1 else touched.all(axis=1))


def _group(loaded: LoadedScenario, groups: Mapping[str, IntArray], name: str, path: KeyPath) -> IntArray:
    if name not in groups:
        tail = hint(name, groups) or f"; known: {listed(sorted(groups), 'and')}"
        raise loaded.error(path, f"no group '{name}'{tail}")
    return groups[name]


def _numbered(
    loaded: LoadedScenario, members: IntArray, which: IndexSet, what: str, path: KeyPath
) -> IntArray:
    wanted = (
        np.array(which.indices)
        if which.indices is not None
        else np.arange(which.range[0], which.range[1] + 1)  # type: ignore[index]
    )
    if wanted.max() >= len(members):
        raise loaded.error(
            path,
            f"{what} {wanted.max()} of '{which.of}' does not exist; it has {len(members)}, counted from 0",
        )
    return members[wanted]
