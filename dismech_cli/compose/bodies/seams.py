"""Seams of the scenario: nodes of shells that become one, and the sides that they join."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ...arrays import IntArray
from ...frozen import frozen
from ...mesh.measure import edge_lengths
from ...scenario.language.seam import Seam
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from ...scenario.values.selection import Selects
from .geometry import Geometry, WeldedSides
from .seam_sides import common_sides, sheet_of, shortest_rim, tied_nodes
from .selection import select_all


@frozen
class Sewn:
    """What the seams of a scenario join.

    Attributes:
        pairs: Nodes that become one, the one whose place counts first, shape (P, 2).
        welded: Sides across which bending passes.
        notes: What each seam joins.
    """

    pairs: IntArray
    welded: tuple[WeldedSides, ...]
    notes: tuple[str, ...]


def find_seams(loaded: LoadedScenario, geometry: Geometry, near: float) -> Sewn:
    """Find what the seams of a scenario join.

    Args:
        loaded: The scenario.
        geometry: Its bodies, not joined yet.
        near: Distance [m] up to which nodes coincide unless a seam says otherwise.

    Raises:
        ScenarioError: Shells of a seam have no side in common, or meet node to side rather than node to
            node.
    """
    pairs, welded, notes = [np.empty((0, 2), dtype=np.int64)], [], []
    chosen = select_all(loaded, geometry, Selects.SEWN)[Selects.SEWN]
    for index, joint in enumerate(loaded.scenario.joints):
        if not isinstance(joint, Seam):
            continue
        path: KeyPath = ("joints", index)
        sheets = [sheet_of(geometry, name, chosen.get((*path, "where"))) for name in joint.shells]
        within = near if joint.within is None else joint.within
        if joint.within is not None and within > 0.25 * shortest_rim(geometry, sheets):
            raise loaded.error(
                (*path, "within"), "more than a quarter of the shortest side on the rims of these shells"
            )
        met: set[str] = set()
        for one, two in combinations(sheets, 2):
            tied = tied_nodes(loaded, path, geometry.nodes, (one, two), within)
            if not len(tied):
                continue
            sides = common_sides(loaded, path, geometry.nodes, (one, two), tied)
            if not len(sides):
                continue
            met |= {one.name, two.name}
            # Nodes that meet beside the seam stay apart.
            pairs.append(tied[np.isin(tied[:, 0], sides)])
            if joint.bending == "weld":
                welded.append(WeldedSides((one.number, two.number), sides))
            length = edge_lengths(geometry.nodes, sides).sum()
            how = "welded" if joint.bending == "weld" else "hinged"
            notes.append(
                f"joints[{index}]: '{one.name}' and '{two.name}' {how} along {len(sides)} "
                f"{'side' if len(sides) == 1 else 'sides'}, {length:.4g} m."
            )
        for sheet in sheets:
            if sheet.name not in met:
                raise loaded.error(
                    (*path, "shells", sheets.index(sheet)),
                    f"'{sheet.name}' has no side in common with the others, on a rim, within {within:.3g} m",
                )
    return Sewn(np.concatenate(pairs), tuple(welded), tuple(notes))
