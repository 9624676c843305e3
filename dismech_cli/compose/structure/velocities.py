"""Velocities of the scenario at t = 0."""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...csv_columns import read_columns
from ...kinematics.dofs import DofMap
from ...scenario.language.motion import InitialVelocity, VelocityFile
from ..scene import Scene


def initial_velocity(scene: Scene, dofs: DofMap, before: FloatArray) -> FloatArray:
    """Velocity of every DOF at t = 0, shape (n,).

    Args:
        scene: The scene.
        dofs: Numbering.
        before: What is not given one has this, shape (n,).

    Raises:
        ScenarioError: A file does not fit its nodes, or a velocity leaves the plane of a planar scene.
    """
    v = before.copy()
    hidden = [axis for axis in range(3) if axis not in dofs.axes]
    for index, entry in enumerate(scene.scenario.initial_velocity):
        values = _nodal(scene, index, entry)
        if np.any(values[:, hidden]):
            raise scene.error(("initial_velocity", index), "has a part out of the plane of the scene")
        nodes = scene.places.nodes(("initial_velocity", index, "where"))
        v[dofs.of_nodes(nodes)] = values[:, list(dofs.axes)]
    return v


def _nodal(scene: Scene, index: int, entry: InitialVelocity) -> FloatArray:
    """Velocity of each selected node [m/s], shape (K, 3)."""
    count = len(scene.places.nodes(("initial_velocity", index, "where")))
    if not isinstance(entry.velocity, VelocityFile):
        return np.tile(entry.velocity, (count, 1))
    columns = read_columns(scene.loaded.directory / entry.velocity.file, entry.velocity.columns)
    values = np.stack(columns, axis=1)
    if len(values) != count:
        raise scene.error(
            ("initial_velocity", index, "velocity"),
            f"the file has {len(values)} rows for {count} selected nodes",
        )
    return values
