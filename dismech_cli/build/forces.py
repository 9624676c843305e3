"""Forces of the scenario as terms of the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..forces.gravity import weight
from ..forces.load import DeadLoad
from ..forces.moment import EdgeMoment
from ..forces.resistive import resistive_force
from ..forces.viscous import ViscousDamping
from ..model.dofs import DofMap
from ..model.laws import Law
from ..model.mass import nodal_lengths
from ..model.term import Term
from ..scenario.force import (
    Aerodynamic,
    AreaDamping,
    Buoyancy,
    Distributed,
    Gravity,
    Hydrodynamic,
    LineLoad,
    LineMoment,
    Moment,
    Point,
    Pressure,
    Resistive,
    Thrust,
    Viscous,
)
from ..scenario.load import LoadedScenario
from .geometry import Geometry
from .inertia import nodal_mass, nodal_volume
from .laws import ToLaw, components, vanishes
from .selection import select_nodes
from .shell_edges import ShellEdges
from .shell_forces import line_lengths, line_moments, shell_drag, shell_load


@dataclass(frozen=True, slots=True)
class Forces:
    """Force terms, sorted by their place in the energy account.

    Attributes:
        gravitational: Weight and buoyancy: conservative, counted as potential energy.
        loads: Loads whose work is counted as external.
        dissipative: Forces that take energy out.
    """

    gravitational: tuple[DeadLoad, ...]
    loads: tuple[Term, ...]
    dissipative: tuple[Term, ...]

    @property
    def all(self) -> tuple[Term, ...]:
        """Every force."""
        return (*self.gravitational, *self.loads, *self.dissipative)


def build_forces(
    loaded: LoadedScenario,
    geometry: Geometry,
    free: ShellEdges,
    dofs: DofMap,
    payload: FloatArray,
    laws: ToLaw,
) -> Forces:
    """Make the force terms.

    Args:
        loaded: The scenario.
        geometry: The bodies.
        free: Shell edges with free normals.
        dofs: Numbering.
        payload: Point mass of each node [kg], shape (n_nodes,).
        laws: Laws of time from those of the scenario.

    Raises:
        ScenarioError: A selection is empty or a force leaves the plane of a planar scene.
    """
    gravitational: list[DeadLoad] = []
    loads: list[Term] = []
    dissipative: list[Term] = []
    gravities = [
        (index, components(force.acceleration, laws))
        for index, force in enumerate(loaded.scenario.forces)
        if isinstance(force, Gravity)
    ]
    for index, force in enumerate(loaded.scenario.forces):
        name = f"{force.type}[{index}]"
        match force:
            case Gravity():
                mass = nodal_mass(geometry, dofs.n_nodes, payload)
                vector = components(force.acceleration, laws)
                gravitational += _loads(loaded, dofs, name, (index, "acceleration"), vector, mass)
            case Buoyancy():
                volume = nodal_volume(geometry, dofs.n_nodes)
                for number, vector in gravities:
                    label = f"{name} in gravity[{number}]"
                    gravitational += _loads(
                        loaded, dofs, label, (index,), vector, -force.fluid_density * volume
                    )
            case Point():
                nodes = select_nodes(loaded, geometry, force.where, ("forces", index, "where"))
                once = np.bincount(nodes, minlength=dofs.n_nodes).astype(np.float64)
                vector = components(force.force, laws)
                loads += _loads(loaded, dofs, name, (index, "force"), vector, once)
            case LineLoad():
                path = ("forces", index, "where")
                length = line_lengths(loaded, geometry, dofs.n_nodes, force.where, path)
                vector = components(force.force_per_length, laws)
                loads += _loads(loaded, dofs, name, (index, "force_per_length"), vector, length)
            case LineMoment():
                loads += line_moments(loaded, geometry, free, dofs, name, index, force, laws)
            case Distributed():
                length = _nodal(geometry, dofs.n_nodes, _selected(geometry, force.rods))
                vector = components(force.force_per_length, laws)
                loads += _loads(loaded, dofs, name, (index, "force_per_length"), vector, length)
            case Moment():
                nodes = select_nodes(loaded, geometry, force.where, ("forces", index, "where"))
                loads += _moments(loaded, geometry, dofs, name, index, nodes, components(force.moment, laws))
            case Viscous():
                length = _nodal(geometry, dofs.n_nodes, _selected(geometry, force.rods))
                damped = np.flatnonzero(length)
                dissipative.append(
                    ViscousDamping(
                        name,
                        dofs.of_nodes(damped).reshape(-1),
                        np.repeat(force.coefficient * length[damped], dofs.dimension),
                    )
                )
            case Resistive():
                wet = np.flatnonzero(_selected(geometry, force.rods))
                dissipative.append(
                    resistive_force(
                        name,
                        dofs,
                        geometry.edges[wet],
                        geometry.lengths[wet],
                        force.tangential,
                        force.normal,
                    )
                )
            case Aerodynamic() | Hydrodynamic() | AreaDamping():
                dissipative.append(shell_drag(name, force, geometry, dofs))
            case Pressure() | Thrust():
                loads.append(shell_load(name, force, geometry, dofs, payload, laws))
    return Forces(tuple(gravitational), tuple(loads), tuple(dissipative))


def _nodal(geometry: Geometry, n_nodes: int, per_length: FloatArray) -> FloatArray:
    """Nodal sums of a density per rest length, shape (n_nodes,); walls get nothing."""
    return nodal_lengths(n_nodes, geometry.edges, geometry.lengths * per_length)


def _selected(geometry: Geometry, names: Sequence[str] | None) -> FloatArray:
    """1 on the edges of the named rods (all by default), 0 elsewhere, shape (E,)."""
    chosen = np.array([names is None or rod.name in names for rod in geometry.rods], dtype=np.bool_)
    return chosen[geometry.edge_rod].astype(np.float64)


def _loads(
    loaded: LoadedScenario,
    dofs: DofMap,
    name: str,
    path: tuple[str | int, ...],
    vector: tuple[Law, ...],
    nodal: FloatArray,
) -> Iterator[DeadLoad]:
    """One dead load per component that does not vanish: vector times a number on each node."""
    for axis, law in _components(loaded, dofs, path, vector):
        unit = np.zeros(3)
        unit[axis] = 1.0
        yield DeadLoad(f"{name}.{'xyz'[axis]}", weight(dofs, nodal, unit), law)


def _components(
    loaded: LoadedScenario, dofs: DofMap, path: tuple[str | int, ...], vector: tuple[Law, ...]
) -> Iterator[tuple[int, Law]]:
    for axis, law in enumerate(vector):
        if vanishes(law):
            continue
        if axis not in dofs.axes:
            raise loaded.error(
                ("forces", *path), f"has a part in {'xyz'[axis]}, out of the plane of the scene"
            )
        yield axis, law


def _moments(
    loaded: LoadedScenario,
    geometry: Geometry,
    dofs: DofMap,
    name: str,
    index: int,
    nodes: IntArray,
    vector: tuple[Law, ...],
) -> Iterator[EdgeMoment]:
    """Moments on nodes, shared equally by the rod edges at each node."""
    degree = np.bincount(geometry.edges.reshape(-1), minlength=len(geometry.nodes))
    share = np.zeros(len(geometry.edges))
    for side in (0, 1):
        at = np.isin(geometry.edges[:, side], nodes)
        share[at] += 1.0 / degree[geometry.edges[at, side]]
    edges = np.flatnonzero(share)
    if np.any(degree[nodes] == 0):
        lone = nodes[degree[nodes] == 0][0]
        raise loaded.error(
            ("forces", index, "where"), f"selects node {lone}, which no rod has: a moment acts on rods"
        )
    angles = dofs.of_angles(edges) if dofs.n_angles else np.empty(0, dtype=np.int64)
    for axis, law in enumerate(vector):
        if vanishes(law):
            continue
        # a planar scene turns about its normal only
        if dofs.dimension == 2 and axis in dofs.axes:
            raise loaded.error(
                ("forces", index, "moment"), f"turns about {'xyz'[axis]}, out of the plane of the scene"
            )
        moments = np.zeros((len(edges), 3))
        moments[:, axis] = share[edges]
        yield EdgeMoment(
            f"{name}.{'xyz'[axis]}",
            dofs.of_nodes(geometry.edges[edges, 0]),
            dofs.of_nodes(geometry.edges[edges, 1]),
            angles,
            dofs.axes,
            moments,
            law,
        )
