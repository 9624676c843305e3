"""Elastic energies of rods."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from typing import Any

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...energies.bend_isotropic import BEND_ISOTROPIC
from ...energies.stretch import STRETCH, STRETCH_PLANAR, axial
from ...energies.stretch_neo_hookean import (
    STRETCH_NEO_HOOKEAN,
    STRETCH_NEO_HOOKEAN_PLANAR,
    axial_neo_hookean,
)
from ...frozen import frozen
from ...kernels.shape import Kernel
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..structure.plan import Bending
from ..structure.structure import Structure
from .corners import CORNERS, Corners
from .framed import framed_bending
from .halves import Halves
from .joints import in_series, node_dofs
from .planar import in_plane, planar_bending


def _no_stiffness() -> FloatArray:
    return np.empty((2, 0))


def _no_rods() -> IntArray:
    return np.empty((0, 2), dtype=np.int64)


def _no_places() -> IntArray:
    return np.empty((0, 12), dtype=np.int64)


@frozen(kw_only=True)
class RodEnergies:
    """What the rods give to the model.

    Attributes:
        stretch: Stretching energy of the geometry's edges, or None without rods.
        axial: Energy, tension and slope of an edge by its length, its natural strain and the
            constants of ``stretch``.
        bending: Bending energy of the joints, with that of twisting where rods are framed; None
            without joints.
        corners: Energy of the joints at an angle, or None without them.
        bending_stiffness: EI1 and EI2 of each joint [N m^2], shape (2, J).
        in_plane: Planar scenes: which natural curvature (0 or 1) lies in the plane, and its sign,
            per rod, shape (rods, 2).
        directors: Framed scenes: places of the directors of each joint, shape (J, 12).
        welds: Joints of ``bending`` that are between rods, where these can be driven.
    """

    stretch: StencilEnergy | None = None
    axial: Callable[..., Any] = axial
    bending: StencilEnergy | None = None
    corners: Corners | None = None
    bending_stiffness: FloatArray = field(default_factory=_no_stiffness)
    in_plane: IntArray = field(default_factory=_no_rods)
    directors: IntArray = field(default_factory=_no_places)
    welds: Halves | None = None

    @property
    def terms(self) -> tuple[StencilEnergy, ...]:
        """All that there are."""
        corners = None if self.corners is None else self.corners.energy
        return tuple(one for one in (self.stretch, self.bending, corners) if one is not None)


def rod_energies(scene: Scene, structure: Structure) -> RodEnergies:
    """Make the energies of all rods.

    Raises:
        ScenarioError: A section or a list of natural strains does not fit.
    """
    bending = structure.plan.bending
    if bending is Bending.NONE:
        return RodEnergies()
    joints, geometry = structure.skeleton.joints, scene.geometry
    names = ("bending_1", "bending_2")
    stiffness = np.stack([in_series(geometry, structure.skeleton, name) for name in names])
    law = STRETCHES[bool(_rubber(scene).any())]
    stretch = _stretch(scene, structure, law)
    inside = in_plane(scene, structure) if bending is Bending.PLANAR else _no_rods()
    corners = CORNERS[bending](scene, structure, inside)
    if len(joints.triples) == 0:
        return RodEnergies(
            stretch=stretch,
            axial=law.axial,
            corners=corners,
            bending_stiffness=stiffness,
            in_plane=inside,
        )
    places, welds = _no_places(), None
    if bending is Bending.FRAMED:
        energy, welds, places = framed_bending(scene, structure, stiffness)
    elif bending is Bending.PLANAR:
        energy, welds = planar_bending(scene, structure, stiffness, inside)
    else:
        energy = _isotropic(structure, stiffness)
    return RodEnergies(
        stretch=stretch,
        axial=law.axial,
        bending=energy,
        corners=corners,
        bending_stiffness=stiffness,
        in_plane=inside,
        directors=places,
        welds=welds,
    )


@frozen
class Stretching:
    """How the edges of a scene stretch.

    Attributes:
        kernels: By the dimension of the scene.
        axial: What the kernels follow along an edge.
        constants: Names and values of their stiffnesses: from EA of all edges [N], and a mask of those
            of rubber.
    """

    kernels: Mapping[int, Kernel]
    axial: Callable[..., Any]
    constants: Callable[[FloatArray, BoolArray], dict[str, FloatArray]]


# Whether any rod is of rubber: its kernel takes in the linear rods beside it.
STRETCHES: Mapping[bool, Stretching] = {
    False: Stretching({2: STRETCH_PLANAR, 3: STRETCH}, axial, lambda stiffness, rubber: {"EA": stiffness}),
    True: Stretching(
        {2: STRETCH_NEO_HOOKEAN_PLANAR, 3: STRETCH_NEO_HOOKEAN},
        axial_neo_hookean,
        lambda stiffness, rubber: {
            "EA": np.where(rubber, 0.0, stiffness),
            "muA": np.where(rubber, stiffness / 3.0, 0.0),
        },
    ),
}


def _rubber(scene: Scene) -> BoolArray:
    """Which edges of rods are of rubber, shape (E,)."""
    geometry, materials = scene.geometry, scene.scenario.materials
    of_rod = np.array([materials[rod.material].model == "neo_hookean" for rod in geometry.rods], dtype=bool)
    return of_rod[geometry.edge_rod]


def _stretch(scene: Scene, structure: Structure, law: Stretching) -> StencilEnergy:
    geometry = scene.geometry
    edges = geometry.edges
    natural = np.zeros(len(edges))
    for rod in geometry.rods:
        if rod.natural.stretch is not None:
            natural[geometry.rod_edges[rod.name]] = rod.natural.stretch
    rest = structure.skeleton.rest_lengths[: len(edges)]
    constants = law.constants(geometry.per_edge("axial"), _rubber(scene))
    return StencilEnergy.of(
        "stretch",
        law.kernels[structure.dofs.dimension],
        node_dofs(structure.dofs, edges),
        {"eps": natural, "length": rest} | constants,
    )


def _isotropic(structure: Structure, stiffness: FloatArray) -> StencilEnergy:
    joints = structure.skeleton.joints
    return StencilEnergy.of(
        "bending",
        BEND_ISOTROPIC,
        node_dofs(structure.dofs, joints.triples),
        {"EI": stiffness[0], "voronoi": joints.voronoi},
    )
