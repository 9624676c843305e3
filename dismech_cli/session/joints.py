"""Every joint of a scene in words: what it joins, where, and what passes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..compose.bodies.geometry import Geometry, Joined
from ..compose.structure.hubs import hubs_of, members_of
from ..frozen import frozen


@frozen(kw_only=True)
class JointLine:
    """A joint, or several that one line of the scenario or one mesh file makes between two bodies.

    Attributes:
        source: What says so.
        members: Its nodes, or its bodies where there are several.
        nodes: How many nodes it makes one.
        at: Where the first one is [m].
        passes: Force, bending, twist.
        gap: How far apart the nodes were at most [m].
    """

    source: str
    members: tuple[str, ...]
    nodes: int
    at: tuple[float, float, float]
    passes: tuple[str, ...]
    gap: float

    def __str__(self) -> str:
        x, y, z = (f"{coordinate:.4g}" for coordinate in self.at)
        where = f"({x}, {y}, {z}) m" if self.nodes == 1 else f"{self.nodes} nodes from ({x}, {y}, {z}) m on"
        apart = f", {self.gap:.3g} m apart at most" if self.gap else ""
        return f"{self.source}: {' + '.join(self.members)} at {where}{apart}: {', '.join(self.passes)}"


def joint_lines(geometry: Geometry, *, planar: bool) -> tuple[JointLine, ...]:
    """All joints of a scene.

    Args:
        geometry: The bodies, joined.
        planar: Whether nothing can twist.
    """
    groups: dict[tuple[str, tuple[str, ...], tuple[str, ...]], list[Joined]] = {}
    for one in geometry.joined:
        passes = ("force", *(what for what in one.passes if not (planar and what == "twist")))
        source = "mesh file" if one.joint is None else f"joints[{one.joint}]"
        groups.setdefault((source, one.bodies, passes), []).append(one)
    return (
        *(_line(geometry, key, some) for key, some in groups.items()),
        *_branches(geometry, planar=planar),
    )


def _line(
    geometry: Geometry, key: tuple[str, tuple[str, ...], tuple[str, ...]], some: list[Joined]
) -> JointLine:
    source, bodies, passes = key
    return JointLine(
        source=source,
        members=some[0].members if len(some) == 1 else bodies,
        nodes=len(some),
        at=_place(geometry, some[0].node),
        passes=passes,
        gap=max(one.gap for one in some),
    )


def _branches(geometry: Geometry, *, planar: bool) -> Iterator[JointLine]:
    """Where three edges of one rod and more meet in its mesh."""
    hubs = hubs_of(geometry)
    members = members_of(geometry, hubs)
    rod_of = geometry.edge_rod[members.edge]
    for index, rod in enumerate(geometry.rods):
        counts = np.bincount(members.hub[rod_of == index], minlength=len(hubs))
        # two edges of it run through a joint to others
        own = np.flatnonzero(counts > 2)
        if len(own):
            first = int(np.argmax(members.hub == own[0]))
            yield JointLine(
                source="mesh",
                members=(f"{rod.name} branches",),
                nodes=len(own),
                at=_place(geometry, int(geometry.edges[members.edge[first], members.side[first]])),
                passes=("force", "bending") if planar else ("force", "bending", "twist"),
                gap=0.0,
            )


def _place(geometry: Geometry, node: int) -> tuple[float, float, float]:
    x, y, z = geometry.nodes[node].tolist()
    return x, y, z
