"""Forces on the nodes of all bodies as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...forces.load import DeadLoad
from ...model.term import Term
from ...scenario.language.force import Buoyancy, Gravity, Point
from ..bodies.selection import select_nodes
from ..laws import components
from ..structure.masses import nodal_mass, nodal_volume
from .followers import carried_at_nodes, follower_loads
from .setting import Place, Setting, dead_loads


def gravity(setting: Setting, place: Place, force: Gravity) -> Iterator[DeadLoad]:
    """Weight of the bodies and of their payload."""
    mass = nodal_mass(setting.geometry, setting.dofs.n_nodes, setting.payload)
    vector = components(force.acceleration, setting.laws)
    return dead_loads(setting, place.name, place.key("acceleration"), vector, mass)


def buoyancy(setting: Setting, place: Place, force: Buoyancy) -> Iterator[DeadLoad]:
    """Lift against each gravity of the scene."""
    volume = nodal_volume(setting.geometry, setting.dofs.n_nodes)
    for number, other in enumerate(setting.loaded.scenario.forces):
        if isinstance(other, Gravity):
            name = f"{place.name} in {Place.of(number, other).name}"
            vector = components(other.acceleration, setting.laws)
            yield from dead_loads(setting, name, place.key(), vector, -force.fluid_density * volume)


def point(setting: Setting, place: Place, force: Point) -> Iterator[Term]:
    """The same force on each selected node."""
    nodes = select_nodes(setting.loaded, setting.geometry, force.where, place.key("where"))
    path, vector = place.key("force"), components(force.force, setting.laws)
    if force.follower:
        return follower_loads(setting, place.name, path, vector, carried_at_nodes(setting, nodes))
    once = np.bincount(nodes, minlength=setting.dofs.n_nodes).astype(np.float64)
    return dead_loads(setting, place.name, path, vector, once)
