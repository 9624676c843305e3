"""Rods welded to shells, as elastic energies.

A weld bends and twists over the half of the rod's edge on its side, as the joint at a clamp does: the
shell is the wall. The triangles that it turns with share its stiffness by their areas, so that it does
not grow with their number; it has no mass.
"""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...energies.rod_shell import rod_shell_terms
from ...kinematics.rod_frames import RodFrames
from ...model.stencil import StencilEnergy
from ..bodies.geometry import Geometry, ShellWeld
from ..scene import Scene
from ..structure.structure import Structure


def weld_energies(scene: Scene, structure: Structure) -> tuple[StencilEnergy, ...]:
    """The energies of all welds.

    Raises:
        ScenarioError: A rod runs along the only triangles that it could turn with.
    """
    geometry, dofs, frames = scene.geometry, structure.dofs, structure.rod_frames
    if not geometry.shell_welds:
        return ()
    far, faces, share, stiffness = [], [], [], []
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
        stiffness.append(_stiffness(geometry, weld))
    counts = [len(found) for found in faces]
    edge = np.repeat([weld.edge for weld in geometry.shell_welds], counts)
    node = np.repeat([weld.node for weld in geometry.shell_welds], counts)
    assert isinstance(frames, RodFrames)
    places = frames.director_places(edge)
    rest = frames.transport(frames.rest(structure.rest), structure.rest)
    return rod_shell_terms(
        "welds",
        dofs,
        structure.positions,
        np.column_stack((np.concatenate(far), node)),
        geometry.triangles[np.concatenate(faces)],
        dofs.of_angles(edge),
        np.where(geometry.edges[edge, 1] == node, 1.0, -1.0),
        rest.auxiliary[places].reshape(-1, 2, 3).transpose(1, 0, 2),
        np.repeat(np.array(stiffness).T, counts, axis=1) * np.concatenate(share),
        places,
    )


def _faces(geometry: Geometry, weld: ShellWeld, other: int, footprint: float) -> IntArray:
    """Triangles that turn with the rod: of the shells at the node, none of them with the rod's other node."""
    triangles = geometry.triangles
    around = (triangles == weld.node).any(axis=1)
    middle = geometry.nodes[triangles].mean(axis=1)
    near = np.linalg.norm(middle - geometry.nodes[weld.node], axis=1) <= footprint
    near &= np.isin(geometry.triangle_shell, geometry.triangle_shell[around])
    return np.flatnonzero((around | near) & ~(triangles == other).any(axis=1))


def _stiffness(geometry: Geometry, weld: ShellWeld) -> FloatArray:
    """Stiffness against twist and against bending about m1 and m2 [N m], shape (3,)."""
    rod = geometry.properties[geometry.edge_rod[weld.edge]]
    half = 0.5 * geometry.lengths[weld.edge]
    twist = 0.0 if weld.release == "twist" else rod.torsional
    # curvature 1 is a rotation about m2, curvature 2 one about m1
    bending = (0.0, 0.0) if weld.release == "bending" else (rod.bending_2, rod.bending_1)
    stiffness: FloatArray = np.array((twist, *bending)) / half
    return stiffness
