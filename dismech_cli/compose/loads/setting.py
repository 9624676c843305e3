"""What the builders of forces may look at, and the dead loads that many of them make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray
from ...forces.gravity import weight
from ...forces.load import DeadLoad
from ...kinematics.dofs import DofMap
from ...kinematics.rod_frames import Frames
from ...kinematics.shell_frames import ShellFrames
from ...laws.laws import Law
from ...scenario.language.force import Force
from ...scenario.load import LoadedScenario
from ..bodies.geometry import Geometry
from ..bodies.selection import KeyPath
from ..laws import ToLaw, vanishes
from ..shells.topology import ShellEdges
from ..structure.numbering import Numbering


@dataclass(frozen=True, slots=True)
class Setting:
    """The scene around the forces.

    Attributes:
        loaded: The scenario.
        geometry: The bodies.
        free: Shell edges with free normals.
        normals: Frames of those normals, or None.
        numbering: DOFs and their values at rest.
        frames: Frames of the rods, or their absence.
        payload: Point mass of each node [kg], shape (n_nodes,).
        laws: Laws of time from those of the scenario.
    """

    loaded: LoadedScenario
    geometry: Geometry
    free: ShellEdges
    normals: ShellFrames | None
    numbering: Numbering
    frames: Frames
    payload: FloatArray
    laws: ToLaw

    @property
    def dofs(self) -> DofMap:
        """Numbering."""
        return self.numbering.dofs


@dataclass(frozen=True, slots=True)
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


def parts(setting: Setting, path: KeyPath, vector: tuple[Law, ...]) -> Iterator[tuple[int, Law]]:
    """The components of a vector that do not vanish: axis and law.

    Raises:
        ScenarioError: One leaves the plane of a planar scene.
    """
    for axis, law in enumerate(vector):
        if vanishes(law):
            continue
        if axis not in setting.dofs.axes:
            raise setting.loaded.error(path, f"has a part in {'xyz'[axis]}, out of the plane of the scene")
        yield axis, law


def dead_loads(
    setting: Setting, name: str, path: KeyPath, vector: tuple[Law, ...], nodal: FloatArray
) -> Iterator[DeadLoad]:
    """One dead load per component that does not vanish: vector times a number on each node.

    Args:
        setting: The scene.
        name: Unique name, before that of the component.
        path: Key of the vector.
        vector: Law of each component.
        nodal: The numbers, shape (n_nodes,).

    Raises:
        ScenarioError: A component leaves the plane of a planar scene.
    """
    for axis, law in parts(setting, path, vector):
        unit = np.zeros(3)
        unit[axis] = 1.0
        yield DeadLoad(f"{name}.{'xyz'[axis]}", weight(setting.dofs, nodal, unit), law)
