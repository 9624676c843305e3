"""Words for the nodes of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np

from ...arrays import IntArray
from ...frozen import frozen
from ..bodies.geometry import Geometry


@frozen
class NodeLabels(Sequence[str]):
    """Body and number of every node, put into words when somebody asks.

    Attributes:
        bodies: Kind and name of each body, and the number of its nodes.
        body: Body of each node, -1 without, shape (N,).
        number: Its place there, shape (N,).
    """

    bodies: tuple[tuple[str, int], ...]
    body: IntArray
    number: IntArray

    def __len__(self) -> int:
        """How many nodes there are."""
        return len(self.body)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[str, ...]: ...

    def __getitem__(self, index: int | slice) -> str | tuple[str, ...]:
        """The words for a node, or for several."""
        match index:
            case slice():
                return tuple(self[i] for i in range(len(self))[index])
            case _:
                body = int(self.body[index])
                if body < 0:
                    return ""
                kind, count = self.bodies[body]
                return f"{kind}, node {self.number[index]} of {count}"


def node_labels(geometry: Geometry) -> NodeLabels:
    """Body and number of every node; of several bodies at a node the first."""
    body, number = (np.full(len(geometry.nodes), -1) for _ in range(2))
    shells = {shell.name for shell in geometry.shells}
    bodies = []
    for k, (name, nodes) in enumerate(geometry.body_nodes.items()):
        bodies.append((f"{'shell' if name in shells else 'rod'} '{name}'", len(nodes)))
        first, at = np.unique(nodes, return_index=True)
        new = body[first] < 0
        body[first[new]], number[first[new]] = k, at[new]
    return NodeLabels(tuple(bodies), body, number)
