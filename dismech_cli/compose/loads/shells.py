"""Forces on shells as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...mesh.measure import edge_lengths, nodal_areas, nodal_lengths
from ...mesh.topology.shells import rims
from ...mesh.topology.sides import half_edges, side_counts
from ...model.term import Term
from ...scenario.language.force import (
    Aerodynamic,
    AreaDamping,
    Hydrodynamic,
    LineLoad,
    LineMoment,
    Pressure,
    Thrust,
)
from ..bodies.geometry import Geometry
from ..laws import components, vanishes
from ..scene import Scene
from ..structure.masses import nodal_mass
from ..structure.structure import Structure
from .vectors import Place, Vector, dead_loads


def aerodynamic(scene: Scene, structure: Structure, place: Place, force: Aerodynamic) -> Iterator[Term]:
    """Quadratic drag along the normals."""
    from ...forces.aerodynamic import aerodynamic_drag
    from .flow import in_flow

    wet = _selected(scene.geometry, force.shells)
    drag = aerodynamic_drag(
        place.name,
        structure.dofs,
        scene.geometry.triangles[wet],
        scene.geometry.areas[wet],
        fluid_density=force.fluid_density,
        coefficient=force.coefficient,
    )
    yield in_flow(scene, structure, place, force.fluid_velocity, drag)


def hydrodynamic(scene: Scene, structure: Structure, place: Place, force: Hydrodynamic) -> Iterator[Term]:
    """Linear drag of a fluid."""
    from ...forces.hydrodynamic import hydrodynamic_drag
    from .flow import in_flow

    area = _nodal_areas(scene, structure, force.shells)
    drag = hydrodynamic_drag(
        place.name, structure.dofs, area, fluid_density=force.fluid_density, coefficient=force.coefficient
    )
    yield in_flow(scene, structure, place, force.fluid_velocity, drag)


def area_damping(scene: Scene, structure: Structure, place: Place, force: AreaDamping) -> Iterator[Term]:
    """Linear damping by area."""
    from ...forces.hydrodynamic import area_damping as damping_term

    yield damping_term(
        place.name, structure.dofs, _nodal_areas(scene, structure, force.shells), force.coefficient
    )


def pressure(scene: Scene, structure: Structure, place: Place, force: Pressure) -> Iterator[Term]:
    """Pressure on a shell."""
    from ...forces.pressure import pressure as pressure_term

    triangles = structure.shell_edges.bodies[force.shell].triangles
    _refuse_branches(scene, place, force.shell, triangles)
    yield pressure_term(place.name, structure.dofs, triangles, scene.laws(force.pressure))


def thrust(scene: Scene, structure: Structure, place: Place, force: Thrust) -> Iterator[Term]:
    """Thrust of a bell.

    Raises:
        ScenarioError: The shell does not have one opening.
    """
    from ...forces.thrust import thrust as thrust_term

    geometry, dofs = scene.geometry, structure.dofs
    triangles = structure.shell_edges.bodies[force.shell].triangles
    _refuse_branches(scene, place, force.shell, triangles)
    openings = rims(triangles)
    if openings != 1:
        raise scene.error(
            place.key("shell"), f"'{force.shell}' has {openings} rims; a bell has one, around its opening"
        )
    # shared by mass, so that the thrust itself accelerates the bell without squeezing it
    mass = nodal_mass(geometry, dofs.n_nodes, structure.payload)
    shares = np.zeros(dofs.n_nodes)
    bell = distinct(triangles)
    shares[bell] = mass[bell]
    nodes = np.zeros((dofs.n_nodes, 3))
    nodes[: len(geometry.nodes)] = geometry.nodes
    yield thrust_term(
        place.name,
        dofs,
        nodes,
        triangles,
        coefficient=force.coefficient,
        direction=np.array(force.direction),
        shares=shares,
    )


def _refuse_branches(scene: Scene, place: Place, name: str, triangles: IntArray) -> None:
    """Sheets that meet three and more at an edge have no common side for pressure to act on.

    Raises:
        ScenarioError: The shell branches.
    """
    if (side_counts(triangles) > 2).any():
        raise scene.error(
            place.key("shell"),
            f"'{name}' branches, so that its sheets have no common side: take each as a shell of its "
            "own, by 'group', and join them by a 'seam'",
        )


def line_load(scene: Scene, structure: Structure, place: Place, force: LineLoad) -> Iterator[Term]:
    """Forces on the shell edges between selected nodes, half of each at either end.

    Raises:
        ScenarioError: It selects no edge.
    """
    geometry = scene.geometry
    nodes = scene.places.nodes(place.key("where"))
    sides = np.sort(half_edges(geometry.triangles), axis=1)
    edges = np.unique(sides[np.isin(sides, nodes).all(axis=1)], axis=0)
    if edges.size == 0:
        raise scene.error(place.key("where"), "selects no edge of a shell")
    vector = Vector.of(scene, place.name, place.key("force_per_length"), force.force_per_length)
    if force.follower:
        from .followers import carried_by_sides, follower_loads

        return follower_loads(scene, structure, vector, [carried_by_sides(scene, structure, edges)])
    length = nodal_lengths(structure.dofs.n_nodes, edges, edge_lengths(geometry.nodes, edges))
    return dead_loads(scene, structure, vector, length)


def line_moment(scene: Scene, structure: Structure, place: Place, force: LineMoment) -> Iterator[Term]:
    """Moments on shell edges between selected nodes: across each edge a couple, along it a torque.

    Raises:
        ScenarioError: It selects no edge, or one without a normal to turn.
    """
    from ...forces.edge_torque import EdgeTorque
    from ...forces.moment import EdgeMoment

    dofs, with_normals = structure.dofs, structure.shell_edges.edges
    nodes = scene.places.nodes(place.key("where"))
    edges = np.flatnonzero(np.isin(with_normals, nodes).all(axis=1))
    if edges.size == 0:
        raise scene.error(
            place.key("where"),
            "selects no edge, two nodes of a side, of a shell with bending: midedge, whose normals it turns",
        )
    turned = structure.shell_edges.normals[edges]
    # Sheets that are welded have one normal: a moment on the edge turns it once.
    edges = edges[np.unique(turned, return_index=True)[1]]
    if len(np.unique(np.sort(with_normals[edges], axis=1), axis=0)) < len(edges):
        raise scene.error(
            place.key("where"),
            "selects an edge where sheets turn freely against each other: a moment on which?",
        )
    stored = structure.normals.edge_places(edges)[:, :3]
    tails, heads = (dofs.of_nodes(with_normals[edges, k]) for k in (0, 1))
    lengths = edge_lengths(scene.geometry.nodes, with_normals[edges])
    for axis, law in enumerate(components(force.moment_per_length, scene.laws)):
        if vanishes(law):
            continue
        moments = np.zeros((len(edges), 3))
        moments[:, axis] = lengths
        label = f"{place.name}.{'xyz'[axis]}"
        across = np.empty(0, dtype=np.int64)
        yield EdgeMoment(f"{label}.couple", tails, heads, across, dofs.axes, moments, law)
        yield EdgeTorque(
            f"{label}.torque", tails, heads, structure.normals.angles[edges], stored, moments, law
        )


def _nodal_areas(scene: Scene, structure: Structure, names: Sequence[str] | None) -> FloatArray:
    """Area of the named shells at each node [m^2], shape (n_nodes,)."""
    geometry = scene.geometry
    wet = _selected(geometry, names)
    return nodal_areas(structure.dofs.n_nodes, geometry.triangles[wet], geometry.areas[wet])


def _selected(geometry: Geometry, names: Sequence[str] | None) -> IntArray:
    """Triangles of the named shells, or of all."""
    chosen = np.array([names is None or shell.name in names for shell in geometry.shells], dtype=np.bool_)
    return np.flatnonzero(chosen[geometry.triangle_shell])
