"""Holds of the scenario as prescribed DOFs of the model."""

from __future__ import annotations

from math import inf

import numpy as np

from ...arrays import IntArray
from ...kinematics.motion import Motion
from ...laws.laws import Law
from ..laws import vanishes
from ..scene import Scene
from .holds import AXES, ZERO
from .structure import Structure


def build_motions(scene: Scene, structure: Structure) -> tuple[Motion, ...]:
    """Hold node positions, edge angles, mid-edge normals, and the walls behind clamped rod ends.

    Raises:
        ScenarioError: A motion leaves the plane of a planar scene, or two motions hold one DOF and do
            not both keep it at rest for good.
    """
    dofs, skeleton = structure.dofs, structure.skeleton
    n_nodes, n_edges = len(scene.geometry.nodes), len(scene.geometry.edges)
    motions: list[Motion] = []
    owner = np.full(dofs.n, -1)
    resting = np.zeros(dofs.n, dtype=np.bool_)

    def hold(index: int, label: str, held: IntArray, law: Law, release: float) -> None:
        if vanishes(law) and release == inf:
            # sides that meet at a corner may both hold it
            held = held[~resting[held]]
            resting[held] = True
        if held.size == 0:
            return
        rival = owner[held].max()
        if rival >= 0:
            twice = dofs.describe(int(held[np.argmax(owner[held])]))
            raise scene.error(("motions", index), f"holds {twice}, which motions[{rival}] holds already")
        owner[held] = index
        motions.append(Motion(label, held, structure.rest[held], law, release))

    for index, one in enumerate(structure.holds):
        walls = np.flatnonzero(np.isin(skeleton.wall_nodes, one.walls))
        nodes = np.concatenate((one.nodes, n_nodes + walls))
        for axis in range(3):
            law = one.displacement[axis]
            if axis not in dofs.axes:
                if not vanishes(law):
                    raise scene.error(
                        ("motions", index, "displacement", axis),
                        f"{AXES[axis]} is out of the plane of the scene",
                    )
                continue
            if axis in one.axes:
                held = dofs.of_nodes(nodes)[:, dofs.axes.index(axis)]
                hold(index, f"{one.name} {AXES[axis]}", held, law, one.release)
        if dofs.n_angles:
            edges = np.concatenate((one.edges, n_edges + walls))
            hold(index, f"{one.name} twist", dofs.of_angles(edges), one.twist, one.release)
        elif not vanishes(one.twist):
            raise scene.error(("motions", index), "turns no edge: the scene has no rod that can twist")
        normals = np.flatnonzero(np.isin(structure.shell_edges.edges, one.sloped).all(axis=1))
        hold(index, f"{one.name} normals", dofs.of_normals(normals), ZERO, one.release)
    return tuple(motions)
