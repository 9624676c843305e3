"""Probes of the scenario as numbers read from the running model."""

from __future__ import annotations

from operator import attrgetter

import numpy as np

from ...arrays import IntArray, union
from ...run.observables import probes
from ...scenario.language.probe import (
    BendProbe,
    ContactProbe,
    ControlProbe,
    DisplacementProbe,
    DistanceProbe,
    EnergyProbe,
    LoadFactorProbe,
    MeanPositionProbe,
    PositionProbe,
    Probe,
    ReactionProbe,
    SensorProbe,
    ShapeProbe,
    StabilityProbe,
    TurnProbe,
    TwistProbe,
    VelocityProbe,
)
from ...scenario.text.tree import KeyPath
from ..control.control import Control
from ..scene import Scene
from ..structure.structure import Structure
from ..touching import named_pairs

_FORCES = {
    "force": (attrgetter("normal"), attrgetter("friction")),
    "normal": (attrgetter("normal"),),
    "friction": (attrgetter("friction"),),
}
_NUMBERS = {
    "load": (attrgetter("load"), "N"),
    "places": (attrgetter("counts"), "1"),
    "depth": (attrgetter("depth"), "1"),
}

AXES = {"x": 0, "y": 1, "z": 2, "magnitude": None}


def make_probes(scene: Scene, structure: Structure, control: Control) -> dict[str, probes.Probe]:
    """The probes of the output, by name."""
    given = scene.scenario.output.probes
    return {
        name: make_probe(scene, structure, control, probe, ("output", "probes", name))
        for name, probe in given.items()
    }


def make_watched(scene: Scene, structure: Structure, control: Control) -> dict[str, probes.Probe]:
    """The probes of the expectations, by name; what several ask for is one."""
    made: list[tuple[Probe, probes.Probe]] = []
    watched = {}
    for name, one in scene.scenario.expect.items():
        same = next((probe for asked, probe in made if asked == one.probe), None)
        watched[name] = same or make_probe(scene, structure, control, one.probe, ("expect", name, "probe"))
        made.append((one.probe, watched[name]))
    return watched


def make_probe(
    scene: Scene, structure: Structure, control: Control, probe: Probe, path: KeyPath
) -> probes.Probe:
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
            nodes = _held_with(scene, structure, scene.places.nodes((*path, "reaction")))
            behind = len(geometry.nodes) + np.flatnonzero(np.isin(structure.skeleton.wall_nodes, nodes))
            return probes.Reaction(np.concatenate((nodes, behind)), AXES[probe.component])
        case TwistProbe():
            if structure.dofs.n_angles == 0:
                raise scene.error((*path, "twist"), "the scene has no rod that can twist")
            return probes.TwistAngle(structure.dofs.of_angles(scene.places.edges((*path, "twist"))))
        case TurnProbe():
            edges = geometry.edges[scene.places.edges((*path, "turn"))]
            along = geometry.nodes[edges[:, 1]] - geometry.nodes[edges[:, 0]]
            return probes.Turn(edges, along / np.linalg.norm(along, axis=1)[:, None])
        case BendProbe():
            about = np.array(probe.about)
            return probes.Bend(_line(scene, probe, path), about / np.linalg.norm(about))
        case LoadFactorProbe():
            return probes.LoadFactor()
        case ContactProbe():
            return _touch_probe(scene, probe, path)
        case SensorProbe() | ControlProbe() | ShapeProbe():
            from ..control.probes import control_probe

            return control_probe(scene, control, probe, path)
        case StabilityProbe():
            return probes.NegativeEigenvalues()


def _line(scene: Scene, probe: BendProbe, path: KeyPath) -> IntArray:
    """Nodes of a line.

    Raises:
        ScenarioError: The body has no such node.
    """
    nodes = scene.geometry.body_nodes[probe.bend]
    for k, node in enumerate(probe.nodes):
        if node >= len(nodes):
            message = f"{probe.bend!r} has {len(nodes)} nodes, counted from 0; there is no {node}"
            raise scene.error((*path, "nodes", k), message)
    return nodes[list(probe.nodes)]


def _held_with(scene: Scene, structure: Structure, nodes: IntArray) -> IntArray:
    """Nodes and, where they are all that a clamp names, the rest of what it holds: the far end of an edge."""
    for index, hold in enumerate(structure.holds):
        if hold.nodes.size and np.isin(scene.places.nodes(("motions", index, "where")), nodes).all():
            nodes = union(nodes, hold.nodes)
    return nodes


def _touch_probe(scene: Scene, probe: ContactProbe, path: KeyPath) -> probes.Probe:
    """A probe of a pair that may touch.

    Raises:
        ScenarioError: The two may not.
    """
    a, b = probe.contact
    pairs = named_pairs(scene.scenario)
    pair = next((pair for pair in ((a, b), (b, a)) if pair in pairs), None)
    if pair is None:
        raise scene.error((*path, "contact"), f"contact has no pair of {a!r} and {b!r}")
    if probe.measure in _FORCES:
        return probes.TouchForce(
            pair, 1.0 if pair == (a, b) else -1.0, _FORCES[probe.measure], AXES[probe.component]
        )
    return probes.TouchNumber(pair, *_NUMBERS[probe.measure])
