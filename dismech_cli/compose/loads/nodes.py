"""Forces on the nodes of all bodies as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...forces.load import DeadLoad
from ...model.term import Term
from ...scenario.language.force import Buoyancy, Gravity, Point
from ..scene import Scene
from ..structure.masses import nodal_mass, nodal_volume
from ..structure.structure import Structure
from .vectors import Place, Vector, dead_loads


def gravity(scene: Scene, structure: Structure, place: Place, force: Gravity) -> Iterator[DeadLoad]:
    """Weight of the bodies and of their payload."""
    mass = nodal_mass(scene.geometry, structure.dofs.n_nodes, structure.payload)
    vector = Vector.of(scene, place.name, place.key("acceleration"), force.acceleration)
    return dead_loads(scene, structure, vector, mass)


def buoyancy(scene: Scene, structure: Structure, place: Place, force: Buoyancy) -> Iterator[DeadLoad]:
    """Lift against each gravity of the scene."""
    volume = nodal_volume(scene.geometry, structure.dofs.n_nodes)
    for number, other in enumerate(scene.scenario.forces):
        if isinstance(other, Gravity):
            name = f"{place.name} in {Place.of(number, other).name}"
            vector = Vector.of(scene, name, place.key(), other.acceleration)
            yield from dead_loads(scene, structure, vector, -force.fluid_density * volume)


def point(scene: Scene, structure: Structure, place: Place, force: Point) -> Iterator[Term]:
    """The same force on each selected node."""
    nodes = scene.places.nodes(place.key("where"))
    vector = Vector.of(scene, place.name, place.key("force"), force.force)
    if force.follower:
        from .followers import carried_at_nodes, follower_loads

        return follower_loads(scene, structure, vector, carried_at_nodes(scene, structure, nodes))
    once = np.bincount(nodes, minlength=structure.dofs.n_nodes).astype(np.float64)
    return dead_loads(scene, structure, vector, once)
