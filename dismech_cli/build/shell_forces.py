"""Forces on shells as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..arrays import FloatArray, IntArray
from ..forces.aerodynamic import aerodynamic_drag
from ..forces.edge_torque import EdgeTorque
from ..forces.hydrodynamic import area_damping, hydrodynamic_drag
from ..forces.moment import EdgeMoment
from ..forces.pressure import pressure
from ..forces.thrust import thrust
from ..model.dofs import DofMap
from ..model.mass import nodal_lengths
from ..model.shell import edge_lengths, nodal_areas
from ..model.term import Term
from ..scenario.force import Aerodynamic, AreaDamping, Hydrodynamic, LineMoment, Pressure, Thrust
from ..scenario.load import LoadedScenario
from ..scenario.selection import Selection
from .geometry import Geometry
from .inertia import nodal_mass
from .laws import ToLaw, components, vanishes
from .selection import KeyPath, select_nodes
from .shell_edges import ShellEdges


def shell_drag(
    name: str, force: Aerodynamic | Hydrodynamic | AreaDamping, geometry: Geometry, dofs: DofMap
) -> Term:
    """The drag of a fluid on shells."""
    wet = _selected(geometry, force.shells)
    triangles, areas = geometry.triangles[wet], geometry.areas[wet]
    match force:
        case Aerodynamic():
            return aerodynamic_drag(
                name,
                dofs,
                triangles,
                areas,
                fluid_density=force.fluid_density,
                coefficient=force.coefficient,
            )
        case Hydrodynamic():
            area = nodal_areas(dofs.n_nodes, triangles, areas)
            return hydrodynamic_drag(
                name, dofs, area, fluid_density=force.fluid_density, coefficient=force.coefficient
            )
        case AreaDamping():
            return area_damping(name, dofs, nodal_areas(dofs.n_nodes, triangles, areas), force.coefficient)


def shell_load(
    name: str, force: Pressure | Thrust, geometry: Geometry, dofs: DofMap, payload: FloatArray, laws: ToLaw
) -> Term:
    """Pressure on a shell, or its thrust.

    Args:
        name: Unique name.
        force: As in the scenario.
        geometry: The bodies.
        dofs: Numbering.
        payload: Point mass of each node [kg], shape (n_nodes,).
        laws: Laws of time from those of the scenario.
    """
    triangles = geometry.triangles[geometry.triangles_of(force.shell)]
    match force:
        case Pressure():
            return pressure(name, dofs, triangles, laws(force.pressure))
        case Thrust():
            # shared by mass, so that the thrust itself accelerates the bell without squeezing it
            mass = nodal_mass(geometry, dofs.n_nodes, payload)
            shares = np.zeros(dofs.n_nodes)
            bell = np.unique(triangles)
            shares[bell] = mass[bell]
            nodes = np.zeros((dofs.n_nodes, 3))
            nodes[: len(geometry.nodes)] = geometry.nodes
            return thrust(
                name,
                dofs,
                nodes,
                triangles,
                coefficient=force.coefficient,
                direction=np.array(force.direction),
                shares=shares,
            )


def line_lengths(
    loaded: LoadedScenario, geometry: Geometry, n_nodes: int, where: Selection, path: KeyPath
) -> FloatArray:
    """Half the length of every shell edge between selected nodes at each of its ends [m], (n_nodes,).

    Raises:
        ScenarioError: It selects no edge.
    """
    nodes = select_nodes(loaded, geometry, where, path)
    sides = np.sort(geometry.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(sides[np.isin(sides, nodes).all(axis=1)], axis=0)
    if edges.size == 0:
        raise loaded.error(path, "selects no edge of a shell")
    return nodal_lengths(n_nodes, edges, edge_lengths(geometry.nodes, edges))


def line_moments(
    loaded: LoadedScenario,
    geometry: Geometry,
    free: ShellEdges,
    dofs: DofMap,
    name: str,
    index: int,
    force: LineMoment,
    laws: ToLaw,
) -> Iterator[Term]:
    """Moments on shell edges between selected nodes: across each edge a couple, along it a torque.

    Raises:
        ScenarioError: It selects no edge, or one without a normal to turn.
    """
    path = ("forces", index, "where")
    nodes = select_nodes(loaded, geometry, force.where, path)
    edges = np.flatnonzero(np.isin(free.edges, nodes).all(axis=1))
    if edges.size == 0:
        raise loaded.error(path, "selects no edge of a shell with mid-edge bending")
    tails, heads = (dofs.of_nodes(free.edges[edges, k]) for k in (0, 1))
    lengths = edge_lengths(geometry.nodes, free.edges[edges])
    for axis, law in enumerate(components(force.moment_per_length, laws)):
        if vanishes(law):
            continue
        moments = np.zeros((len(edges), 3))
        moments[:, axis] = lengths
        label = f"{name}.{'xyz'[axis]}"
        across = np.empty(0, dtype=np.int64)
        yield EdgeMoment(f"{label}.couple", tails, heads, across, dofs.axes, moments, law)
        yield EdgeTorque(
            f"{label}.torque", tails, heads, dofs.of_normals(edges), edges, dofs.n_normals, moments, law
        )


def _selected(geometry: Geometry, names: Sequence[str] | None) -> IntArray:
    """Triangles of the named shells, or of all."""
    chosen = np.array([names is None or shell.name in names for shell in geometry.shells], dtype=np.bool_)
    return np.flatnonzero(chosen[geometry.triangle_shell])
