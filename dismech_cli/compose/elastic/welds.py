"""Rods welded to shells, as elastic energies.

A weld bends and twists over the half of the rod's edge on its side, as the joint at a clamp does: the
shell is the wall. The triangles that it turns with share its stiffness by their areas, so that it does
not grow with their number; it has no mass.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...energies.rod_shell import ROD_ON_FACE, rod_shell_terms
from ...kinematics.rod_frames import RodFrames
from ...model.stencil import StencilEnergy
from ..bodies.geometry import Geometry, ShellWeld
from ..scene import Scene
from ..structure.joints import Joints, number_joints
from ..structure.structure import Structure
from .halves import Halves, halves_in_space


def weld_energies(scene: Scene, structure: Structure) -> tuple[tuple[StencilEnergy, Halves], ...]:
    """The energies of all welds, and what natural strains of their rods do to them.

    Raises:
        ScenarioError: A rod runs along the only triangles that it could turn with, or a list of natural
            strains does not fit.
    """
    geometry, dofs, frames = scene.geometry, structure.dofs, structure.rod_frames
    if not geometry.shell_welds:
        return ()
    far, faces, share = [], [], []
    for weld in geometry.shell_welds:
        other = int(geometry.edges[weld.edge].sum()) - weld.node
        found = _faces(geometry, weld, other, weld.footprint)
        if len(found) == 0:
            raise scene.error(
                ("joints", weld.joint), "the rod lies along every triangle around this node; weld another"
            )
        far.append(np.full(len(found), other))
        faces.append(found)
        share.append(geometry.areas[found] / geometry.areas[found].sum())
    counts = [len(found) for found in faces]
    stiffness = _stiffness(geometry, geometry.shell_welds)
    edge = np.repeat([weld.edge for weld in geometry.shell_welds], counts)
    node = np.repeat([weld.node for weld in geometry.shell_welds], counts)
    assert isinstance(frames, RodFrames)
    places = frames.director_places(edge)
    rest = frames.transport(frames.rest(structure.rest), structure.rest)
    ends = np.column_stack((np.concatenate(far), node))
    signs = np.where(geometry.edges[edge, 1] == node, 1.0, -1.0)
    joints = _as_joints(scene, structure, edge, ends, signs)
    terms = []
    for energy, mine in rod_shell_terms(
        "welds",
        dofs,
        structure.positions,
        ends,
        geometry.triangles[np.concatenate(faces)],
        dofs.of_angles(edge),
        signs,
        rest.auxiliary[places].reshape(-1, 2, 3).transpose(1, 0, 2),
        np.repeat(stiffness, counts, axis=1) * np.concatenate(share),
        places,
    ):
        some = joints.some(np.isin(np.arange(len(edge)), mine))
        # the face turns as one: what bends is the rod's half alone, along its own axes
        halves = halves_in_space(some, np.arange(len(mine)), np.zeros((len(mine), 3, 3)))
        grown = halves.natural(scene)
        terms.append((energy.having(dict(zip(ROD_ON_FACE.naturals, grown, strict=True))), halves))
    return tuple(terms)


def _as_joints(
    scene: Scene, structure: Structure, edge: IntArray, ends: IntArray, signs: FloatArray
) -> Joints:
    """The welds as joints of half an edge with what bends nothing, one per face.

    Args:
        scene: The scene.
        structure: What moves.
        edge: Edge of the rod, shape (S,).
        ends: Its far node and that at the joint, shape (S, 2).
        signs: Whether it runs to the joint, shape (S,).
    """
    geometry = scene.geometry
    triples, twice = ends[:, [0, 1, 1]], [0, 0]
    rods = geometry.edge_rod[edge][:, None][:, twice]
    half = 0.5 * geometry.lengths[edge]
    return Joints(
        triples,
        edge[:, None][:, twice],
        signs[:, None][:, twice],
        np.stack((half, np.zeros_like(half)), axis=1),
        rods,
        number_joints(geometry, triples, rods),
        np.zeros((len(edge), 2), dtype=np.bool_),
        structure.skeleton.joints.counts,
    )


def _faces(geometry: Geometry, weld: ShellWeld, other: int, footprint: float) -> IntArray:
    """Triangles that turn with the rod: of the shells at the node, none of them with the rod's other node."""
    triangles = geometry.triangles
    around = (triangles == weld.node).any(axis=1)
    middle = geometry.nodes[triangles].mean(axis=1)
    near = np.linalg.norm(middle - geometry.nodes[weld.node], axis=1) <= footprint
    near &= np.isin(geometry.triangle_shell, geometry.triangle_shell[around])
    return np.flatnonzero((around | near) & ~(triangles == other).any(axis=1))


def _stiffness(geometry: Geometry, welds: Sequence[ShellWeld]) -> FloatArray:
    """Stiffness of each against twist and against bending about m1 and m2 [N m], shape (3, W)."""
    edges = [weld.edge for weld in welds]
    twist = np.array([weld.release != "twist" for weld in welds])
    bending = np.array([weld.release != "bending" for weld in welds])
    # curvature 1 is a rotation about m2, curvature 2 one about m1
    kept = (("torsional", twist), ("bending_2", bending), ("bending_1", bending))
    values = np.stack([passes * geometry.per_edge(name)[edges] for name, passes in kept])
    stiffness: FloatArray = values / (0.5 * geometry.lengths[edges])
    return stiffness
