"""What the geometry makes doubtful: said by ``dismech check`` and before a run."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from ...arrays import FloatArray, IntArray, median
from ...mesh.measure import corner_angles
from ...mesh.suspects import suspects
from ...scenario.language.motion import Clamp
from ...scenario.language.numerics import Static
from ..scene import Scene
from ..shells.bending import bending_of
from .holds import Hold
from .parts import adrift, find_parts, in_parts

# 0 on equilateral nets, whatever their rims; 8 on unstructured ones, 10 on discs, 21 on right angles.
_UNEVEN = 6.0
# At this turn [rad] of a section's axes within a joint their mean stiffness is 4 % off.
_TURNED = 0.5
# Nodes nearer than this fraction of the size of the scene were meant to be one.
_SAME_PLACE = 1e-9


def scene_doubts(scene: Scene, holds: tuple[Hold, ...]) -> Iterator[str]:
    """Warnings, each with its place in the scenario."""
    yield from scene.geometry.doubts
    yield from _uneven_meshes(scene)
    yield from _twisted_sections(scene)
    yield from _single_rows(scene, holds)
    yield from _touching(scene)
    parts = find_parts(scene.geometry)
    yield from in_parts(scene, parts)
    if isinstance(scene.scenario.numerics.integrator, Static):
        yield from adrift(scene, parts, holds)


def _twisted_sections(scene: Scene) -> Iterator[str]:
    """Sections that are not round and turn too far from joint to joint for their axes to be followed."""
    geometry = scene.geometry
    for key, rod, section in zip(geometry.rod_keys, geometry.rods, geometry.properties, strict=True):
        if rod.natural.twist is None or section.isotropic:
            continue
        edges = geometry.rod_edges[rod.name]
        turn = float(np.abs(rod.natural.twist).max() * geometry.lengths[edges].mean())
        if turn > _TURNED:
            finer = int(np.ceil(len(edges) * turn / _TURNED)) + 1
            yield scene.loaded.warning(
                ("geometry", key, "natural", "twist"),
                f"turns the section of '{rod.name}', which is not round, by {turn:.2g} rad from joint to "
                f"joint: the mesh cannot follow its axes; take about {finer} nodes",
            )


def _uneven_meshes(scene: Scene) -> Iterator[str]:
    """Models that are right between equilateral triangles only, between others."""
    geometry = scene.geometry
    for key, shell in zip(geometry.shell_keys, geometry.shells, strict=True):
        off = unevenness(geometry.nodes, geometry.triangles[geometry.triangles_of(shell.name)])
        if off <= _UNEVEN:
            continue
        start = f"the corners of '{shell.name}' are {off:.0f} degrees off those of equilateral triangles: "
        if not bending_of(shell).converges:
            yield scene.loaded.warning(
                ("geometry", key, "bending"),
                f"{start}bending '{shell.bending}' depends on the mesh there and does not converge; "
                "take 'midedge'",
            )
        if shell.membrane != "cst":
            yield scene.loaded.warning(
                ("geometry", key, "membrane"),
                f"{start}springs along edges stretch by the mesh there; take 'cst'",
            )


def unevenness(nodes: FloatArray, triangles: IntArray) -> float:
    """How far the corners of the typical triangle are from 60 degrees [deg].

    The median over triangles, so that the halved ones at the rim of an equilateral net do not
    count, of the root mean square over corners.
    """
    square = ((np.degrees(corner_angles(nodes, triangles)) - 60.0) ** 2).mean(axis=0)
    return median(np.sqrt(square))


def _single_rows(scene: Scene, holds: tuple[Hold, ...]) -> Iterator[str]:
    """Clamps that a shell without normals of its own can turn about."""
    geometry = scene.geometry
    held = np.zeros(len(geometry.nodes), dtype=bool)
    for hold in holds:
        held[hold.nodes] = True
    for index, (motion, hold) in enumerate(zip(scene.scenario.motions, holds, strict=True)):
        if not isinstance(motion, Clamp):
            continue
        for shell in geometry.shells:
            triangles = geometry.triangles[geometry.triangles_of(shell.name)]
            touched = np.isin(triangles, hold.nodes).any(axis=1)
            if bending_of(shell).has_normals or not touched.any() or held[triangles].all(axis=1).any():
                continue
            yield scene.loaded.warning(
                ("motions", index, "where"),
                f"holds no whole triangle of '{shell.name}', which can turn about it: bending "
                f"'{shell.bending}' knows no slope at a rim; hold two rows of nodes, or take 'midedge'",
            )


def _touching(scene: Scene) -> Iterator[str]:
    """Bodies with nodes at one place that no joint made one."""
    geometry = scene.geometry
    if len(geometry.body_nodes) < 2:
        return
    near = _SAME_PLACE * float(np.ptp(geometry.nodes, axis=0).max())
    asked = suspects(geometry.nodes, near)
    if not len(asked):
        return
    from scipy.spatial import KDTree

    pairs = asked[KDTree(geometry.nodes[asked]).query_pairs(near, output_type="ndarray")]
    for one, two in combinations(geometry.body_nodes, 2):
        a, b = geometry.body_nodes[one], geometry.body_nodes[two]
        here = (np.isin(pairs, a).any(axis=1) & np.isin(pairs, b).any(axis=1)).sum()
        if here:
            key = next(k for k, body in enumerate(scene.scenario.geometry) if body.name == two)
            yield scene.loaded.warning(
                ("geometry", key),
                f"'{one}' and '{two}' touch, with nodes at the same place ({here}), but nothing joins them; "
                "if they belong together, add a joint, or joints: auto",
            )
