"""Words for the nodes of a scene."""

from __future__ import annotations

from ..bodies.geometry import Geometry


def node_labels(geometry: Geometry) -> tuple[str, ...]:
    """Body and number of every node."""
    words = [""] * len(geometry.nodes)
    shells = {shell.name for shell in geometry.shells}
    for name, nodes in geometry.body_nodes.items():
        kind = "shell" if name in shells else "rod"
        for number, node in enumerate(nodes):
            words[node] = words[node] or f"{kind} '{name}', node {number} of {len(nodes)}"
    return tuple(words)
