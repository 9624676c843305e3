"""Probes of the scenario as numbers read from the running model."""

from __future__ import annotations

import numpy as np

from ...kinematics.dofs import DofMap
from ...run.observables import probes as made
from ...scenario.language import probe as said
from ...scenario.load import LoadedScenario
from ..bodies.geometry import Geometry
from ..bodies.selection import KeyPath, select_edges, select_nodes
from ..structure.skeleton import Skeleton

AXES = {"x": 0, "y": 1, "z": 2, "magnitude": None}


def build_probe(
    loaded: LoadedScenario,
    geometry: Geometry,
    skeleton: Skeleton,
    dofs: DofMap,
    probe: said.Probe,
    path: KeyPath,
) -> made.Probe:
    """Resolve a probe.

    Raises:
        ScenarioError: Its selection is empty.
    """
    origin = np.zeros(3)
    match probe:
        case said.DisplacementProbe():
            nodes = select_nodes(loaded, geometry, probe.displacement, (*path, "displacement"))
            return made.Position(nodes, geometry.nodes[nodes].mean(axis=0), AXES[probe.component])
        case said.PositionProbe():
            nodes = select_nodes(loaded, geometry, probe.position, (*path, "position"))
            return made.Position(nodes, origin, AXES[probe.component])
        case said.VelocityProbe():
            nodes = select_nodes(loaded, geometry, probe.velocity, (*path, "velocity"))
            return made.Velocity(nodes, AXES[probe.component])
        case said.DistanceProbe():
            first, second = (
                select_nodes(loaded, geometry, side, (*path, "distance", k))
                for k, side in enumerate(probe.distance)
            )
            return made.Distance(first, second)
        case said.MeanPositionProbe():
            return made.Position(geometry.body_nodes[probe.mean_position], origin, AXES[probe.component])
        case said.EnergyProbe():
            return made.Energy(probe.energy)
        case said.ReactionProbe():
            nodes = select_nodes(loaded, geometry, probe.reaction, (*path, "reaction"))
            behind = len(geometry.nodes) + np.flatnonzero(np.isin(skeleton.wall_nodes, nodes))
            return made.Reaction(np.concatenate((nodes, behind)), AXES[probe.component])
        case said.TwistProbe():
            edges = select_edges(loaded, geometry, probe.twist, (*path, "twist"))
            if dofs.n_angles == 0:
                raise loaded.error((*path, "twist"), "the scene has no rod that can twist")
            return made.TwistAngle(dofs.of_angles(edges))
        case said.StabilityProbe():
            return made.NegativeEigenvalues()
