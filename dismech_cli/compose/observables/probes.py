"""Probes of the scenario as numbers read from the running model."""

from __future__ import annotations

import numpy as np

from ...run.observables import probes
from ...scenario.language.probe import (
    DisplacementProbe,
    DistanceProbe,
    EnergyProbe,
    MeanPositionProbe,
    PositionProbe,
    Probe,
    ReactionProbe,
    StabilityProbe,
    TwistProbe,
    VelocityProbe,
)
from ...scenario.text.tree import KeyPath
from ..scene import Scene
from ..structure.structure import Structure

AXES = {"x": 0, "y": 1, "z": 2, "magnitude": None}


def make_probes(scene: Scene, structure: Structure) -> dict[str, probes.Probe]:
    """The probes of the output, by name."""
    given = scene.scenario.output.probes
    return {
        name: _probe(scene, structure, probe, ("output", "probes", name)) for name, probe in given.items()
    }


def make_watched(scene: Scene, structure: Structure) -> dict[str, probes.Probe]:
    """The probes of the expectations, by name."""
    given = scene.scenario.expect
    return {
        name: _probe(scene, structure, one.probe, ("expect", name, "probe")) for name, one in given.items()
    }


def _probe(scene: Scene, structure: Structure, probe: Probe, path: KeyPath) -> probes.Probe:
    """Put a probe on its place.

    Raises:
        ScenarioError: It measures twist where there is none.
    """
    geometry, origin = scene.geometry, np.zeros(3)
    match probe:
        case DisplacementProbe():
            nodes = scene.places.nodes((*path, "displacement"))
            return probes.Position(nodes, geometry.nodes[nodes].mean(axis=0), AXES[probe.component])
        case PositionProbe():
            return probes.Position(scene.places.nodes((*path, "position")), origin, AXES[probe.component])
        case VelocityProbe():
            return probes.Velocity(scene.places.nodes((*path, "velocity")), AXES[probe.component])
        case DistanceProbe():
            first, second = (scene.places.nodes((*path, "distance", side)) for side in (0, 1))
            return probes.Distance(first, second)
        case MeanPositionProbe():
            return probes.Position(geometry.body_nodes[probe.mean_position], origin, AXES[probe.component])
        case EnergyProbe():
            return probes.Energy(probe.energy)
        case ReactionProbe():
            nodes = scene.places.nodes((*path, "reaction"))
            behind = len(geometry.nodes) + np.flatnonzero(np.isin(structure.skeleton.wall_nodes, nodes))
            return probes.Reaction(np.concatenate((nodes, behind)), AXES[probe.component])
        case TwistProbe():
            if structure.dofs.n_angles == 0:
                raise scene.error((*path, "twist"), "the scene has no rod that can twist")
            return probes.TwistAngle(structure.dofs.of_angles(scene.places.edges((*path, "twist"))))
        case StabilityProbe():
            return probes.NegativeEigenvalues()
