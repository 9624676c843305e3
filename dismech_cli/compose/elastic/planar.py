"""Bending of rods in a plane."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray, IntArray
from ...energies.bend_planar import BEND_PLANAR
from ...kinematics.strains import planar_curvature
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..structure.frames import given_directors, rest_directors
from ..structure.structure import Structure
from .halves import Halves, halves_in_plane
from .joints import natural_density, node_dofs

PLANAR_AXIS: dict[tuple[int, ...], tuple[float, float, float]] = {
    (0, 2): (0.0, -1.0, 0.0),
    (0, 1): (0.0, 0.0, 1.0),
    (1, 2): (1.0, 0.0, 0.0),
}
"""Normal of a plane, about which its curvature is positive."""


def in_plane(scene: Scene, structure: Structure) -> IntArray:
    """For each rod, the material curvature that lies in the plane, and its sign, shape (rods, 2).

    With kappa b = kappa n for the plane's normal n, kappa_1 = kappa n.m2 and kappa_2 = -kappa n.m1.

    Raises:
        ScenarioError: A director is neither in the plane nor normal to it.
    """
    geometry = scene.geometry
    directors = rest_directors(structure.skeleton, given_directors(scene, structure.skeleton))
    out = np.zeros((len(geometry.rods), 2), dtype=np.int64)
    normal = np.array(PLANAR_AXIS[structure.plan.axes])
    for index, rod in enumerate(geometry.rods):
        edges = geometry.rod_edges[rod.name]
        e = geometry.nodes[geometry.edges[edges, 1]] - geometry.nodes[geometry.edges[edges, 0]]
        t = e / np.linalg.norm(e, axis=1)[:, None]
        m1 = directors[:, edges].T
        one, two = np.cross(t, m1) @ normal, -(m1 @ normal)
        for which, values in enumerate((one, two)):
            if np.all(np.abs(np.abs(values) - 1.0) < 1e-9) and np.all(values * values[0] > 0.0):
                out[index] = which, int(np.sign(values[0]))
        if out[index, 1] == 0 and not geometry.properties[index].isotropic:
            raise scene.error(
                ("geometry", geometry.rod_keys[index], "director"),
                "in a planar scene a director must lie in the plane or normal to it",
            )
        if out[index, 1] == 0:
            out[index] = 0, 1
    return out


def planar_bending(
    scene: Scene, structure: Structure, stiffness: FloatArray, inside: IntArray
) -> tuple[StencilEnergy, Halves]:
    """Bending energy of the joints, and those between rods.

    Args:
        scene: The scene.
        structure: What moves.
        stiffness: EI1 and EI2 of each joint [N m^2], shape (2, J).
        inside: The curvature of each rod in the plane, and its sign, shape (rods, 2).

    Raises:
        ScenarioError: A natural curvature leaves the plane, or a list of them does not fit.
    """
    geometry, dofs, joints = scene.geometry, structure.dofs, structure.skeleton.joints
    which = inside[np.maximum(joints.rod, 0), 0]
    natural = planar_curvature(dofs.positions(structure.rest), joints.triples)
    for index in range(len(geometry.rods)):
        component, sign = inside[index]
        density = natural_density(scene, joints, index, f"curvature_{component + 1}")
        if density is not None:
            members = joints.rod == index
            natural[members] = sign * density[joints.number[members]] * joints.voronoi[members]
        hidden = f"curvature_{2 - component}"
        if getattr(geometry.rods[index].natural, hidden) is not None:
            raise scene.error(
                ("geometry", geometry.rod_keys[index], "natural", hidden),
                "bends out of the plane of the scene",
            )
    welds = halves_in_plane(joints.some(joints.rod < 0), np.flatnonzero(joints.rod < 0), inside)
    natural[welds.stencils] += welds.natural(scene)[0]
    energy = StencilEnergy.of(
        "bending",
        BEND_PLANAR,
        node_dofs(dofs, joints.triples),
        {"kappa": natural, "EI": stiffness[which, np.arange(len(which))], "voronoi": joints.voronoi},
    )
    return energy, welds
