"""Where the clamps of a scene act on its rods: at nodes, or half an edge further on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...scenario.language.motion import Clamp
from ..scene import Scene
from .holds import Hold


def clamp_words(scene: Scene, holds: Sequence[Hold]) -> Iterator[tuple[str, str]]:
    """What every clamp of rods holds, and what ``at`` makes of it."""
    edges = scene.geometry.edges
    for index, (motion, hold) in enumerate(zip(scene.scenario.motions, holds, strict=True)):
        if not isinstance(motion, Clamp):
            continue
        nodes = int(np.isin(hold.nodes, edges).sum())
        if not nodes:
            continue
        held = f"{_some(nodes, 'node')} and {_some(len(hold.edges), 'edge')} of rods"
        what = f"clamp motions[{index}] holds {held}"
        if motion.at == "edge":
            yield (
                what,
                (
                    "at: edge, in the middle of the last edges: half an edge further on than at: node, "
                    "which acts at the nodes selected"
                ),
            )
        else:
            walls = len(hold.walls)
            behind = f", {_some(walls, 'end')} of them by a wall behind it" if walls else ""
            yield what, f"at: node, rods bend right up to the nodes selected{behind}"


def _some(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"
