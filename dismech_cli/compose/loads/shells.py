"""Forces on shells as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...forces.aerodynamic import aerodynamic_drag
from ...forces.edge_torque import EdgeTorque
from ...forces.hydrodynamic import area_damping as damping_term
from ...forces.hydrodynamic import hydrodynamic_drag
from ...forces.moment import EdgeMoment
from ...forces.pressure import pressure as pressure_term
from ...forces.thrust import thrust as thrust_term
from ...mesh.topology.shells import rims
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
from ...sections.mass import nodal_lengths
from ...sections.shells import edge_lengths, nodal_areas
from ..bodies.geometry import Geometry
from ..bodies.selection import select_nodes
from ..laws import components, vanishes
from ..structure.masses import nodal_mass
from .followers import carried_by_sides, follower_loads
from .setting import Place, Setting, dead_loads


def aerodynamic(setting: Setting, place: Place, force: Aerodynamic) -> Iterator[Term]:
    """Quadratic drag along the normals."""
    wet = _selected(setting.geometry, force.shells)
    yield aerodynamic_drag(
        place.name,
        setting.dofs,
        setting.geometry.triangles[wet],
        setting.geometry.areas[wet],
        fluid_density=force.fluid_density,
        coefficient=force.coefficient,
    )


def hydrodynamic(setting: Setting, place: Place, force: Hydrodynamic) -> Iterator[Term]:
    """Linear drag of a fluid."""
    area = _nodal_areas(setting, force.shells)
    yield hydrodynamic_drag(
        place.name, setting.dofs, area, fluid_density=force.fluid_density, coefficient=force.coefficient
    )


def area_damping(setting: Setting, place: Place, force: AreaDamping) -> Iterator[Term]:
    """Linear damping by area."""
    yield damping_term(place.name, setting.dofs, _nodal_areas(setting, force.shells), force.coefficient)


def pressure(setting: Setting, place: Place, force: Pressure) -> Iterator[Term]:
    """Pressure on a shell."""
    triangles = setting.geometry.triangles[setting.geometry.triangles_of(force.shell)]
    yield pressure_term(place.name, setting.dofs, triangles, setting.laws(force.pressure))


def thrust(setting: Setting, place: Place, force: Thrust) -> Iterator[Term]:
    """Thrust of a bell.

    Raises:
        ScenarioError: The shell does not have one opening.
    """
    geometry, dofs = setting.geometry, setting.dofs
    triangles = geometry.triangles[geometry.triangles_of(force.shell)]
    openings = rims(triangles)
    if openings != 1:
        raise setting.loaded.error(
            place.key("shell"), f"'{force.shell}' has {openings} rims; a bell has one, around its opening"
        )
    # shared by mass, so that the thrust itself accelerates the bell without squeezing it
    mass = nodal_mass(geometry, dofs.n_nodes, setting.payload)
    shares = np.zeros(dofs.n_nodes)
    bell = np.unique(triangles)
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


def line_load(setting: Setting, place: Place, force: LineLoad) -> Iterator[Term]:
    """Forces on the shell edges between selected nodes, half of each at either end.

    Raises:
        ScenarioError: It selects no edge.
    """
    geometry = setting.geometry
    nodes = select_nodes(setting.loaded, geometry, force.where, place.key("where"))
    sides = np.sort(geometry.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(sides[np.isin(sides, nodes).all(axis=1)], axis=0)
    if edges.size == 0:
        raise setting.loaded.error(place.key("where"), "selects no edge of a shell")
    path, vector = place.key("force_per_length"), components(force.force_per_length, setting.laws)
    if force.follower:
        return follower_loads(setting, place.name, path, vector, [carried_by_sides(setting, edges)])
    length = nodal_lengths(setting.dofs.n_nodes, edges, edge_lengths(geometry.nodes, edges))
    return dead_loads(setting, place.name, path, vector, length)


def line_moment(setting: Setting, place: Place, force: LineMoment) -> Iterator[Term]:
    """Moments on shell edges between selected nodes: across each edge a couple, along it a torque.

    Raises:
        ScenarioError: It selects no edge, or one without a normal to turn.
    """
    dofs, free = setting.dofs, setting.free
    nodes = select_nodes(setting.loaded, setting.geometry, force.where, place.key("where"))
    edges = np.flatnonzero(np.isin(free.edges, nodes).all(axis=1))
    if edges.size == 0:
        raise setting.loaded.error(
            place.key("where"),
            "selects no edge, two nodes of a side, of a shell with bending: midedge, whose normals it turns",
        )
    assert setting.normals is not None
    stored = setting.normals.edge_places(edges)[:, :3]
    tails, heads = (dofs.of_nodes(free.edges[edges, k]) for k in (0, 1))
    lengths = edge_lengths(setting.geometry.nodes, free.edges[edges])
    for axis, law in enumerate(components(force.moment_per_length, setting.laws)):
        if vanishes(law):
            continue
        moments = np.zeros((len(edges), 3))
        moments[:, axis] = lengths
        label = f"{place.name}.{'xyz'[axis]}"
        across = np.empty(0, dtype=np.int64)
        yield EdgeMoment(f"{label}.couple", tails, heads, across, dofs.axes, moments, law)
        yield EdgeTorque(f"{label}.torque", tails, heads, dofs.of_normals(edges), stored, moments, law)


def _nodal_areas(setting: Setting, names: Sequence[str] | None) -> FloatArray:
    """Area of the named shells at each node [m^2], shape (n_nodes,)."""
    geometry = setting.geometry
    wet = _selected(geometry, names)
    return nodal_areas(setting.dofs.n_nodes, geometry.triangles[wet], geometry.areas[wet])


def _selected(geometry: Geometry, names: Sequence[str] | None) -> IntArray:
    """Triangles of the named shells, or of all."""
    chosen = np.array([names is None or shell.name in names for shell in geometry.shells], dtype=np.bool_)
    return np.flatnonzero(chosen[geometry.triangle_shell])
