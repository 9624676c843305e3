"""What the selections of a scenario find: each resolved once, and looked up by its key path."""

from __future__ import annotations

from collections.abc import Mapping

from ..arrays import IntArray
from ..frozen import frozen
from ..scenario.load import LoadedScenario
from ..scenario.text.tree import KeyPath
from ..scenario.values.selection import Selects
from .bodies.geometry import Geometry
from .bodies.selection import select_all


@frozen
class Places:
    """Nodes and edges by the key path of the selection, such as ``("forces", 0, "where")``."""

    _nodes: Mapping[KeyPath, IntArray]
    _edges: Mapping[KeyPath, IntArray]

    def nodes(self, path: KeyPath) -> IntArray:
        """Nodes that a selection finds, ascending, shape (K,)."""
        return self._nodes[path]

    def edges(self, path: KeyPath) -> IntArray:
        """Edges that a selection of edges finds, ascending, shape (K,)."""
        return self._edges[path]


def find_places(loaded: LoadedScenario, geometry: Geometry) -> Places:
    """Resolve every selection on the joined bodies; those of joints were before.

    Raises:
        ScenarioError: All selections that name an unknown group or number, or select nothing.
    """
    found = select_all(loaded, geometry, Selects.NODES, Selects.EDGES)
    return Places(found[Selects.NODES], found[Selects.EDGES])
