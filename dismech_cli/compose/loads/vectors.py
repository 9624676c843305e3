"""Where a force stands in the scenario, its vector of laws, and the dead loads that many make of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import FloatArray
from ...forces.gravity import weight
from ...forces.load import DeadLoad
from ...frozen import frozen
from ...laws.laws import Law
from ...scenario.language.force import Force
from ...scenario.text.tree import KeyPath
from ...scenario.values.law import LawSpec
from ..laws import components, vanishes
from ..scene import Scene
from ..structure.structure import Structure


@frozen
class Place:
    """Where a force stands: its index among the forces of the scenario, and a name made from it."""

    index: int
    name: str

    @staticmethod
    def of(index: int, force: Force) -> Place:
        """The place of a force."""
        return Place(index, f"{force.type}[{index}]")

    def key(self, *path: str) -> KeyPath:
        """Path of one of its keys."""
        return ("forces", self.index, *path)


@frozen
class Vector:
    """A vector of laws, whose components become a load each.

    Attributes:
        name: Unique name of the loads, before that of the component.
        path: Its key.
        laws: Law of each component.
    """

    name: str
    path: KeyPath
    laws: tuple[Law, ...]

    @staticmethod
    def of(scene: Scene, name: str, path: KeyPath, specs: Sequence[LawSpec]) -> Vector:
        """The vector that the scenario gives under a key."""
        return Vector(name, path, components(specs, scene.laws))


def parts(scene: Scene, structure: Structure, vector: Vector) -> Iterator[tuple[int, Law]]:
    """The components of a vector that do not vanish: axis and law.

    Raises:
        ScenarioError: One leaves the plane of a planar scene.
    """
    for axis, law in enumerate(vector.laws):
        if vanishes(law):
            continue
        if axis not in structure.dofs.axes:
            raise scene.error(vector.path, f"has a part in {'xyz'[axis]}, out of the plane of the scene")
        yield axis, law


def dead_loads(scene: Scene, structure: Structure, vector: Vector, nodal: FloatArray) -> Iterator[DeadLoad]:
    """One dead load per component that does not vanish: the vector times a number on each node.

    Args:
        scene: The scene.
        structure: What moves.
        vector: The vector.
        nodal: The numbers, shape (n_nodes,).

    Raises:
        ScenarioError: A component leaves the plane of a planar scene.
    """
    for axis, law in parts(scene, structure, vector):
        unit = np.zeros(3)
        unit[axis] = 1.0
        yield DeadLoad(f"{vector.name}.{'xyz'[axis]}", weight(structure.dofs, nodal, unit), law)
