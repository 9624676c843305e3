"""Springs that keep the length of the stubs at hubs: nothing pulls at them, and their energy is none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...energies.stretch import STRETCH, STRETCH_PLANAR
from ...kernels.shape import Kernel
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..structure.structure import Structure
from .joints import node_dofs, of_edges

_KERNELS: Mapping[int, Kernel] = {
    2: replace(STRETCH_PLANAR, shares=("stretch",)),
    3: replace(STRETCH, shares=("stretch",)),
}


def stub_springs(scene: Scene, structure: Structure) -> Iterator[StencilEnergy]:
    """The springs of all stubs: about as stiff along them as the hub is across them."""
    skeleton = structure.skeleton
    if not len(skeleton.hubs):
        return
    corners, stubs = skeleton.corners, skeleton.stubs
    one, two = (of_edges(scene.geometry, skeleton, name) for name in ("bending_1", "bending_2"))
    bending = np.maximum(one, two)[corners.pairs[:, 0]]
    stiffness = np.zeros(len(skeleton.edges))
    np.add.at(stiffness, corners.pairs[:, 1], bending / corners.voronoi)
    length = skeleton.rest_lengths[stubs]
    yield StencilEnergy.of(
        "stubs",
        _KERNELS[structure.dofs.dimension],
        node_dofs(structure.dofs, skeleton.edges[stubs]),
        {"eps": 0.0, "length": length, "EA": stiffness[stubs] / length},
    )
