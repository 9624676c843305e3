"""Forces on rods as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import FloatArray
from ...mesh.measure import nodal_lengths
from ...model.term import Term
from ...scenario.language.force import Distributed, Moment, Resistive, Viscous
from ..bodies.geometry import Geometry
from ..laws import components, vanishes
from ..scene import Scene
from ..structure.structure import Structure
from .vectors import Place, Vector, dead_loads


def distributed(scene: Scene, structure: Structure, place: Place, force: Distributed) -> Iterator[Term]:
    """A force per rest length."""
    vector = Vector.of(scene, place.name, place.key("force_per_length"), force.force_per_length)
    if force.follower:
        from .followers import carried_by_edges, follower_loads

        carried = carried_by_edges(scene, structure, _selected(scene.geometry, force.rods))
        return follower_loads(scene, structure, vector, [carried])
    return dead_loads(scene, structure, vector, _nodal_lengths(scene, structure, force.rods))


def viscous(scene: Scene, structure: Structure, place: Place, force: Viscous) -> Iterator[Term]:
    """Drag by length, the same in every direction."""
    from ...forces.viscous import ViscousDamping
    from .flow import in_flow

    dofs, length = structure.dofs, _nodal_lengths(scene, structure, force.rods)
    damped = np.flatnonzero(length)
    drag = ViscousDamping(place.name, dofs.of_nodes(damped), force.coefficient * length[damped])
    yield in_flow(scene, structure, place, force.fluid_velocity, drag)


def resistive(scene: Scene, structure: Structure, place: Place, force: Resistive) -> Iterator[Term]:
    """Drag by length, along the rod and across it."""
    from ...forces.resistive import resistive_force
    from .flow import in_flow

    geometry = scene.geometry
    wet = np.flatnonzero(_selected(geometry, force.rods))
    drag = resistive_force(
        place.name, structure.dofs, geometry.edges[wet], geometry.lengths[wet], force.tangential, force.normal
    )
    yield in_flow(scene, structure, place, force.fluid_velocity, drag)


def moment(scene: Scene, structure: Structure, place: Place, force: Moment) -> Iterator[Term]:
    """Moments on nodes, shared equally by the rod edges at each node.

    Raises:
        ScenarioError: A node is none of a rod, or a moment turns out of the plane of the scene.
    """
    from ...forces.moment import EdgeMoment

    geometry, dofs = scene.geometry, structure.dofs
    nodes = scene.places.nodes(place.key("where"))
    degree = np.bincount(geometry.edges.reshape(-1), minlength=len(geometry.nodes))
    share = np.zeros(len(geometry.edges))
    for side in (0, 1):
        at = np.isin(geometry.edges[:, side], nodes)
        share[at] += 1.0 / degree[geometry.edges[at, side]]
    edges = np.flatnonzero(share)
    if np.any(degree[nodes] == 0):
        lone = nodes[degree[nodes] == 0][0]
        raise scene.error(place.key("where"), f"selects node {lone}, which no rod has: a moment acts on rods")
    angles = dofs.of_angles(edges) if dofs.n_angles else np.empty(0, dtype=np.int64)
    for axis, law in enumerate(components(force.moment, scene.laws)):
        if vanishes(law):
            continue
        # a planar scene turns about its normal only
        if dofs.dimension == 2 and axis in dofs.axes:
            raise scene.error(
                place.key("moment"), f"turns about {'xyz'[axis]}, out of the plane of the scene"
            )
        moments = np.zeros((len(edges), 3))
        moments[:, axis] = share[edges]
        yield EdgeMoment(
            f"{place.name}.{'xyz'[axis]}",
            dofs.of_nodes(geometry.edges[edges, 0]),
            dofs.of_nodes(geometry.edges[edges, 1]),
            angles,
            dofs.axes,
            moments,
            law,
        )


def _nodal_lengths(scene: Scene, structure: Structure, names: Sequence[str] | None) -> FloatArray:
    """Length of the named rods at each node [m], shape (n_nodes,); walls get nothing."""
    geometry = scene.geometry
    lengths = geometry.lengths * _selected(geometry, names)
    return nodal_lengths(structure.dofs.n_nodes, geometry.edges, lengths)


def _selected(geometry: Geometry, names: Sequence[str] | None) -> FloatArray:
    """1 on the edges of the named rods (all by default), 0 elsewhere, shape (E,)."""
    chosen = np.array([names is None or rod.name in names for rod in geometry.rods], dtype=np.bool_)
    return chosen[geometry.edge_rod].astype(np.float64)
