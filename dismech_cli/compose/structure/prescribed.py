"""Holds of the scenario as prescribed DOFs of the model."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

import numpy as np

from ...arrays import FloatArray, IntArray
from ...kinematics.carried import CarriedEdges, CarriedNodes, CarriedNormals
from ...kinematics.motion import Motion, Prescribed
from ...kinematics.rigid import Rigid
from ...laws.laws import Law
from ..laws import vanishes
from ..scene import Scene
from .holds import AXES, Hold
from .paths import ZERO
from .structure import Structure


def build_motions(scene: Scene, structure: Structure) -> tuple[Prescribed, ...]:
    """Hold node positions, edge angles, mid-edge normals, the walls behind rod ends, the stubs of hubs.

    Raises:
        ScenarioError: A motion leaves the plane of a planar scene, or two motions hold one DOF and do
            not both keep it at rest for good.
    """
    holder = _Holder(scene, structure)
    for index, one in enumerate(structure.holds):
        _check(scene, structure, index, one)
        if one.path.turning is None:
            holder.shift(index, one)
        else:
            holder.carry(index, one, one.path.turning)
    return tuple(holder.motions)


def _check(scene: Scene, structure: Structure, index: int, one: Hold) -> None:
    """Refuse what leaves a plane or turns nothing."""
    for axis, law in enumerate(one.path.displacement):
        if axis not in structure.dofs.axes and not vanishes(law):
            raise scene.error(
                ("motions", index, "displacement", axis), f"{AXES[axis]} is out of the plane of the scene"
            )
    if not structure.dofs.n_angles and not vanishes(one.twist):
        raise scene.error(("motions", index), "turns no edge: the scene has no rod that can twist")


class _Holder:
    """Collects motions; no DOF twice."""

    def __init__(self, scene: Scene, structure: Structure) -> None:
        self.motions: list[Prescribed] = []
        self._scene = scene
        self._structure = structure
        self._owner = np.full(structure.dofs.n, -1)
        self._resting = np.zeros(structure.dofs.n, dtype=np.bool_)

    def shift(self, index: int, one: Hold) -> None:
        """Hold what is displaced axis by axis, edges and normals as they are."""
        dofs, path, nodes = self._structure.dofs, one.path, self._nodes(one)
        for axis in dofs.axes:
            if axis in one.axes:
                held = dofs.of_nodes(nodes)[:, dofs.axes.index(axis)]
                label = f"{one.name} {AXES[axis]}"
                self._along(index, label, held, path.displacement[axis], one.release, path.places)
        if dofs.n_angles:
            self._along(index, f"{one.name} twist", dofs.of_angles(self._edges(one)), one.twist, one.release)
        self._along(index, f"{one.name} normals", self._turns(self._normals(one)), ZERO, one.release)

    def carry(self, index: int, one: Hold, rigid: Rigid) -> None:
        """Hold what turns as a rigid body, edges and normals with it."""
        for motion in self._carried(one, rigid):
            if motion.dofs.size:
                self._claim(index, motion.dofs)
                self.motions.append(motion)

    def _carried(self, one: Hold, rigid: Rigid) -> Iterator[Prescribed]:
        structure, path, nodes = self._structure, one.path, self._nodes(one)
        dofs = structure.dofs
        yield CarriedNodes(
            f"{one.name} nodes",
            dofs.of_nodes(nodes).reshape(-1),
            structure.positions[nodes],
            rigid,
            path.displacement,
            path.places,
            dofs.axes,
            one.release,
        )
        rest = structure.frames.rest(structure.rest)
        if dofs.n_angles:
            edges = self._edges(one)
            tails, heads = self._ends(structure.skeleton.edges[edges])
            yield CarriedEdges(
                f"{one.name} twist",
                dofs.of_angles(edges),
                edges,
                tails,
                heads,
                rest.tangent[:, edges],
                rest.director[:, edges],
                rigid,
                one.twist,
                one.release,
            )
        normals = self._normals(one)
        tails, heads = self._ends(structure.shell_edges.edges[normals])
        yield CarriedNormals(
            f"{one.name} normals",
            self._turns(normals),
            normals,
            tails,
            heads,
            rest.edge_tangent[:, normals],
            rest.edge_normal[:, normals],
            rigid,
            one.release,
        )

    def _along(
        self,
        index: int,
        label: str,
        held: IntArray,
        law: Law,
        release: float,
        places: FloatArray | float = 0.0,
    ) -> None:
        if vanishes(law) and release == inf:
            # sides that meet at a corner may both hold it
            rest = ~self._resting[held]
            held, places = held[rest], places[rest] if isinstance(places, np.ndarray) else places
            self._resting[held] = True
        if held.size:
            self._claim(index, held)
            self.motions.append(Motion(label, held, self._structure.rest[held], law, release, places))

    def _claim(self, index: int, held: IntArray) -> None:
        rival = self._owner[held].max()
        if rival >= 0:
            twice = self._structure.dofs.describe(int(held[np.argmax(self._owner[held])]))
            raise self._scene.error(
                ("motions", index), f"holds {twice}, which motions[{rival}] holds already"
            )
        self._owner[held] = index

    def _nodes(self, one: Hold) -> IntArray:
        return np.concatenate((one.nodes, len(self._scene.geometry.nodes) + self._walls(one)))

    def _edges(self, one: Hold) -> IntArray:
        return np.concatenate((one.edges, len(self._scene.geometry.edges) + self._walls(one)))

    def _walls(self, one: Hold) -> IntArray:
        return self._structure.skeleton.behind(one)

    def _normals(self, one: Hold) -> IntArray:
        """Edges whose normals are held, one for each normal: those that are welded turn as one."""
        edges = self._structure.shell_edges
        held = np.flatnonzero(np.isin(edges.edges, one.sloped).all(axis=1))
        return held[np.unique(edges.normals[held], return_index=True)[1]]

    def _turns(self, edges: IntArray) -> IntArray:
        return self._structure.normals.angles[edges]

    def _ends(self, edges: IntArray) -> tuple[IntArray, IntArray]:
        dofs = self._structure.dofs
        return np.ascontiguousarray(dofs.of_nodes(edges[:, 0]).T), np.ascontiguousarray(
            dofs.of_nodes(edges[:, 1]).T
        )
