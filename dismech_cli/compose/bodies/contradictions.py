"""Joints that would do nothing of what they say, because others at their node say the opposite."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...frozen import frozen
from ...scenario.load import LoadedScenario
from .geometry import Geometry
from .named import Pair
from .turning import Said, turning_nodes


@frozen
class Loose:
    """A node within a rod that a joint releases.

    Attributes:
        joint: Place of the joint in the scenario's list.
        node: Which it is, of the bodies apart.
        release: What alone does not pass, or None.
    """

    joint: int
    node: int
    release: str | None


def refuse_contradictions(
    loaded: LoadedScenario, geometry: Geometry, said: Said, pairs: Sequence[Pair], loose: Sequence[Loose]
) -> None:
    """Look at every joint for others that undo it.

    Raises:
        ScenarioError: There is one.
    """
    of_node = turning_nodes(len(geometry.nodes), said)
    edges_of = np.bincount(of_node[geometry.edges].reshape(-1), minlength=len(of_node))
    released = {int(of_node[one.node]): one.joint for one in loose if one.release is None}
    for one in loose:
        if edges_of[of_node[one.node]] < 2:
            raise loaded.error(("joints", one.joint), "releases nothing: only one edge of a rod ends here")
    at_shells = {int(of_node[geometry.edges[edge, side]]) for edge, side in said.welds}
    on_shell = geometry.carries_shell
    welding: dict[int, int] = {}
    for pair in pairs:
        numbers = [int(of_node[node]) for node in pair.nodes]
        if not pair.rigid or on_shell[list(pair.nodes)].any():
            continue
        welding |= dict.fromkeys(numbers, pair.joint)
        if not at_shells.isdisjoint(numbers):
            raise loaded.error(
                ("joints", pair.joint), "a shell joins these rods: weld each of them to it instead"
            )
        for number in numbers:
            if number in released:
                raise loaded.error(
                    ("joints", pair.joint),
                    f"passes nothing but force: joints[{released[number]}] releases this node",
                )
    for pair in pairs:
        first, second = (int(of_node[node]) for node in pair.nodes)
        if not pair.rigid and first == second:
            raise loaded.error(
                ("joints", pair.joint), f"releases nothing: joints[{welding[first]}] welds these nodes"
            )
