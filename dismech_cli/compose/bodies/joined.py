"""What became one at joints, and what passes there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import distinct
from .contradictions import Loose
from .geometry import Geometry, Joined, ShellWeld
from .named import Apart, Pair
from .turning import RELEASED, Turning


def joined_by_file(geometry: Geometry, shared: Sequence[tuple[int, int]]) -> Iterator[Joined]:
    """Nodes that a shell and another body took from one place in one file.

    Args:
        geometry: The bodies apart.
        shared: The pairs of nodes.
    """
    words, bodies = _words(geometry) if shared else ([], [])
    for a, b in shared:
        yield Joined(None, (bodies[a], bodies[b]), (words[a], words[b]), a, (), 0.0)


def joined_by_name(
    apart: Apart, turning: Turning, pairs: Sequence[Pair], welds: Sequence[ShellWeld]
) -> Iterator[Joined]:
    """The nodes of joints.

    Args:
        apart: The bodies apart.
        turning: Which of their edges turn as one.
        pairs: What the joints name.
        welds: The edges that turn with shells.
    """
    geometry = apart.geometry
    words, bodies = _words(geometry) if pairs else ([], [])
    welded = {(weld.node, int(node)): weld for weld in welds for node in geometry.edges[weld.edge]}
    for pair in pairs:
        a, b = pair.nodes
        weld = welded.get((a, b)) or welded.get((b, a))
        if weld is not None:
            passes = tuple(what for what in RELEASED if what != weld.release)
        else:
            passes = _passing(geometry, turning, a, b)
        gap = float(np.linalg.norm(geometry.nodes[a] - geometry.nodes[b]))
        gap = gap if gap > apart.near else 0.0
        yield Joined(pair.joint, (bodies[a], bodies[b]), (words[a], words[b]), a, passes, gap)


def released_within(geometry: Geometry, loose: Sequence[Loose]) -> Iterator[Joined]:
    """The nodes within rods that hinges release.

    Args:
        geometry: The bodies apart.
        loose: What the joints release.
    """
    words, bodies = _words(geometry) if loose else ([], [])
    for one in loose:
        passes = () if one.release is None else tuple(what for what in RELEASED if what != one.release)
        yield Joined(one.joint, (bodies[one.node],), (words[one.node],), one.node, passes, 0.0)


def _passing(geometry: Geometry, turning: Turning, a: int, b: int) -> tuple[str, ...]:
    """Which of bending and twist pass between the edges at two nodes."""
    first, second = (distinct(turning.ends[geometry.edges == node]) for node in (a, b))
    if not len(first) or not len(second):
        return ()
    one, other = (grid.reshape(-1) for grid in np.meshgrid(first, second))
    passing = turning.passing(one, other)
    return tuple(what for column, what in enumerate(RELEASED) if passing[:, column].any())


def _words(geometry: Geometry) -> tuple[list[str], list[str]]:
    """The nodes of the bodies in the user's words, and the names of their bodies."""
    words, bodies = ([""] * len(geometry.nodes) for _ in range(2))
    for name, nodes in geometry.body_nodes.items():
        for number, node in enumerate(nodes):
            words[node], bodies[node] = f"{name}[{number}]", name
        for end in ("start", "end"):
            group = geometry.node_groups.get(f"{name}.{end}", nodes)
            if len(group) == 1 and name in geometry.rod_edges:
                words[group[0]] = f"{name}.{end}"
    return words, bodies
